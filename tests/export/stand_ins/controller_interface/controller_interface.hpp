// What the example uses of ros2_control, declared only.
#pragma once
#include <memory>
#include <string>
#include <vector>

namespace rclcpp {
class Time {};
class Duration {
public:
    double seconds() const;
};
class Parameter {
public:
    std::string as_string() const;
    std::vector<std::string> as_string_array() const;
};
}  // namespace rclcpp
namespace rclcpp_lifecycle {
class State {};
class LifecycleNode {
public:
    rclcpp::Parameter get_parameter(const std::string &name) const;
};
}  // namespace rclcpp_lifecycle
namespace controller_interface {
enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
enum class return_type { OK, ERROR };
enum class interface_configuration_type { ALL, INDIVIDUAL, NONE };
struct InterfaceConfiguration {
    interface_configuration_type type;
    std::vector<std::string> names;
};
class LoanedInterface {
public:
    double get_value() const;
    bool set_value(double value);
};
class ControllerInterface {
public:
    virtual ~ControllerInterface() = default;
    virtual CallbackReturn on_init() = 0;
    virtual CallbackReturn on_configure(const rclcpp_lifecycle::State &state);
    virtual CallbackReturn on_activate(const rclcpp_lifecycle::State &state);
    virtual InterfaceConfiguration command_interface_configuration() const = 0;
    virtual InterfaceConfiguration state_interface_configuration() const = 0;
    virtual return_type update(const rclcpp::Time &time, const rclcpp::Duration &period) = 0;
    std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() const;

protected:
    template <typename T>
    void auto_declare(const std::string &name, const T &value);
    std::vector<LoanedInterface> command_interfaces_, state_interfaces_;
};
}  // namespace controller_interface
