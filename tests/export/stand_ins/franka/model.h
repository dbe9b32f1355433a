#pragma once
#include <franka/robot.h>

namespace franka {
class Model {
public:
    std::array<double, 49> mass(const RobotState &state) const noexcept;
    std::array<double, 7> coriolis(const RobotState &state) const noexcept;
    std::array<double, 7> gravity(const RobotState &state) const noexcept;
};
}  // namespace franka
