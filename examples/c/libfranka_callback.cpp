// A libfranka torque callback around an exported controller. Checked for its syntax only: it was not run
// on a robot. Try it first against a simulated robot. Export with
//
//   fotsmc export panda --safeguard --torque-rate 900 --compensates gravity,friction -o ctrl/
//
// since the arm adds gravity and friction compensation to the torque that it is sent: `sent` is the rest.
// libfranka's `control` paces the loop: do not sleep.
#include "fotsmc_panda.h"

#include <franka/exception.h>
#include <franka/model.h>
#include <franka/robot.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

int main(int argc, char **argv) {
    if (argc != 2) { return 2; }
    try {
        franka::Robot robot(argv[1]);
        franka::Model model = robot.loadModel();

        static fotsmc_panda_state controller;
        fotsmc_panda_init(&controller);
        std::array<double, 7> start{};
        double t = 0.0;

        robot.control([&](const franka::RobotState &state, franka::Duration period) -> franka::Torques {
            if (t == 0.0) { start = state.q; }
            // The first call has no period behind it.
            const double dt = period.toSec() > 0.0 ? period.toSec() : FOTSMC_PANDA_DT;
            t += dt;
            std::array<double, 7> q_d = start, v_d{}, a_d{}, tau{};
            q_d[3] += 0.1 * (1.0 - std::cos(t));
            v_d[3] = 0.1 * std::sin(t);
            a_d[3] = 0.1 * std::cos(t);

            const std::array<double, 49> M = model.mass(state);  // symmetric: by columns is by rows
            const std::array<double, 7> g = model.gravity(state), c = model.coriolis(state);
            std::array<double, 7> h{};
            for (std::size_t i = 0; i < 7; i++) { h[i] = c[i] + g[i]; }

            const int status = fotsmc_panda_update(&controller, state.q.data(), state.dq.data(), q_d.data(),
                                                   v_d.data(), a_d.data(), M.data(), h.data(), g.data(), dt,
                                                   tau.data());
            std::copy_n(controller.sent, 7, tau.begin());
            const franka::Torques torques(tau);
            const bool at_rest = std::all_of(state.dq.begin(), state.dq.end(),
                                             [](double v) { return std::fabs(v) < 1e-2; });
            return status != FOTSMC_PANDA_OK && at_rest ? franka::MotionFinished(torques) : torques;
        });
    } catch (const franka::Exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
