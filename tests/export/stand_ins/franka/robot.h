// What the example uses of libfranka, declared only.
#pragma once
#include <array>
#include <functional>
#include <string>

namespace franka {
class Duration {
public:
    double toSec() const noexcept;
};
struct RobotState {
    std::array<double, 7> q, dq;
};
class Torques {
public:
    Torques(const std::array<double, 7> &torques) noexcept;
};
Torques MotionFinished(Torques command) noexcept;
class Model;
class Robot {
public:
    explicit Robot(const std::string &address);
    Model loadModel();
    void control(std::function<Torques(const RobotState &, Duration)> callback);
};
}  // namespace franka
