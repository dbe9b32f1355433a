// A ros2_control controller around an exported one. Checked for its syntax only: it was not run on a robot.
//
// It claims the effort command of each joint and its position and velocity, computes M and h by Pinocchio
// from the URDF in the parameter `urdf`, and holds the pose that it finds when it is activated; a
// real one takes its reference from a topic, through a buffer that does not block. Export with a Safeguard.
// For drives that compensate gravity themselves export with `--compensates gravity`: `sent` is the rest.
#include "fotsmc_panda.h"

#include <controller_interface/controller_interface.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/parsers/urdf.hpp>
#include <pluginlib/class_list_macros.hpp>

#include <string>
#include <vector>

namespace fotsmc {

using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;
using controller_interface::interface_configuration_type;

class Controller : public controller_interface::ControllerInterface {
public:
    CallbackReturn on_init() override {
        auto_declare<std::string>("urdf", "");
        auto_declare<std::vector<std::string>>("joints", {});
        return CallbackReturn::SUCCESS;
    }

    InterfaceConfiguration command_interface_configuration() const override {
        return {interface_configuration_type::INDIVIDUAL, names({"effort"})};
    }

    InterfaceConfiguration state_interface_configuration() const override {
        return {interface_configuration_type::INDIVIDUAL, names({"position", "velocity"})};
    }

    CallbackReturn on_configure(const rclcpp_lifecycle::State &) override {
        pinocchio::urdf::buildModel(get_node()->get_parameter("urdf").as_string(), model_);
        if (model_.nq != FOTSMC_PANDA_NQ || model_.nv != FOTSMC_PANDA_NV) { return CallbackReturn::ERROR; }
        data_ = pinocchio::Data(model_);
        q_.resize(model_.nq);
        v_.resize(model_.nv);
        fotsmc_panda_init(&controller_);
        return CallbackReturn::SUCCESS;
    }

    CallbackReturn on_activate(const rclcpp_lifecycle::State &) override {
        fotsmc_panda_reset(&controller_);
        read_joints();
        hold_ = q_;
        return CallbackReturn::SUCCESS;
    }

    controller_interface::return_type update(const rclcpp::Time &, const rclcpp::Duration &period) override {
        read_joints();
        pinocchio::crba(model_, data_, q_);
        data_.M.triangularView<Eigen::StrictlyLower>() = data_.M.transpose();
        pinocchio::nonLinearEffects(model_, data_, q_, v_);
        pinocchio::computeGeneralizedGravity(model_, data_, q_);
        const double rest[FOTSMC_PANDA_NV] = {0.0};
        double tau[FOTSMC_PANDA_NV];
        // Symmetric: by columns is by rows. A status beside OK means that a safe stop is on.
        fotsmc_panda_update(&controller_, q_.data(), v_.data(), hold_.data(), rest, rest, data_.M.data(),
                            data_.nle.data(), data_.g.data(), period.seconds(), tau);
        for (std::size_t i = 0; i < FOTSMC_PANDA_NV; i++) {
            command_interfaces_[i].set_value(controller_.sent[i]);
        }
        return controller_interface::return_type::OK;
    }

private:
    std::vector<std::string> names(const std::vector<std::string> &kinds) const {
        std::vector<std::string> found;
        for (const std::string &joint : get_node()->get_parameter("joints").as_string_array()) {
            for (const std::string &kind : kinds) { found.push_back(joint + "/" + kind); }
        }
        return found;
    }

    void read_joints() {
        for (std::size_t i = 0; i < FOTSMC_PANDA_NV; i++) {
            q_[static_cast<Eigen::Index>(i)] = state_interfaces_[2 * i].get_value();
            v_[static_cast<Eigen::Index>(i)] = state_interfaces_[2 * i + 1].get_value();
        }
    }

    pinocchio::Model model_;
    pinocchio::Data data_;
    fotsmc_panda_state controller_;
    Eigen::VectorXd q_, v_, hold_;
};

}  // namespace fotsmc

PLUGINLIB_EXPORT_CLASS(fotsmc::Controller, controller_interface::ControllerInterface)
