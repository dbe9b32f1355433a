// Closes the loop in C++: Pinocchio gives M and h to the exported controller, and `aba` moves the arm.
//
// The plant is 30 % heavier than what the controller believes. Compile (see docs/run-it-in-c.md for the
// flags that the headers of the pin wheel need) and give the URDF of the arm without its fingers:
//
//     ./pinocchio_loop panda.urdf
#include "fotsmc_panda.h"

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/parsers/urdf.hpp>

#include <cmath>
#include <cstdio>

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

int main(int argc, char **argv) {
    if (argc != 2) { return 2; }
    pinocchio::Model model;
    pinocchio::urdf::buildModel(argv[1], model);
    if (model.nq != FOTSMC_PANDA_NQ || model.nv != FOTSMC_PANDA_NV) {
        std::fprintf(stderr, "the model has %d joints, the controller %d\n", model.nv, FOTSMC_PANDA_NV);
        return 2;
    }
    pinocchio::Model truth = model;
    for (auto &body : truth.inertias) { body.mass() *= 1.3; body.inertia() *= 1.3; }
    pinocchio::Data data(model), true_data(truth);

    static fotsmc_panda_state controller;
    fotsmc_panda_init(&controller);

    const double dt = FOTSMC_PANDA_DT;
    const Eigen::VectorXd start = pinocchio::neutral(model)
        + 0.5 * (model.lowerPositionLimit + model.upperPositionLimit);
    Eigen::VectorXd q = start, v = Eigen::VectorXd::Zero(model.nv), tau(model.nv);
    double last_error = 0.0;
    for (int k = 0; k < 5000; k++) {
        const double t = k * dt, w = 1.5;
        const Eigen::VectorXd one = Eigen::VectorXd::Ones(model.nv);
        const Eigen::VectorXd q_d = start + 0.2 * (1.0 - std::cos(w * t)) * one;
        const Eigen::VectorXd v_d = 0.2 * w * std::sin(w * t) * one;
        const Eigen::VectorXd a_d = 0.2 * w * w * std::cos(w * t) * one;

        pinocchio::crba(model, data, q);
        data.M.triangularView<Eigen::StrictlyLower>() = data.M.transpose();
        const RowMajor M = data.M;
        const Eigen::VectorXd h = pinocchio::nonLinearEffects(model, data, q, v);
        const int status = fotsmc_panda_update(&controller, q.data(), v.data(), q_d.data(), v_d.data(),
                                               a_d.data(), M.data(), h.data(), dt, tau.data());
        if (status != FOTSMC_PANDA_OK) { return 1; }

        v += dt * pinocchio::aba(truth, true_data, q, v, tau);
        q = pinocchio::integrate(model, q, dt * v);
        if (k >= 4000) { last_error = std::fmax(last_error, (q - q_d).cwiseAbs().maxCoeff()); }
    }
    std::printf("largest error in the last second: %.3g mrad\n", 1e3 * last_error);
    return last_error < 2e-3 ? 0 : 1;
}
