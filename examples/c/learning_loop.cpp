// Closes the loop in C++ with an exported controller that learns its model; Pinocchio gives it what it asks for.
//
// The plant is 30 % heavier than the file and has friction. Export with `fotsmc export panda --learn --delay 0`,
// compile like `pinocchio_loop.cpp`, and give the URDF of the arm without its fingers:
//
//     ./learning_loop panda.urdf
#include "fotsmc_panda.h"

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/parsers/urdf.hpp>

#include <cmath>
#include <cstdio>

using Vector = Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Dynamic = Eigen::Matrix<double, 10, 1>;
constexpr int NQ = FOTSMC_PANDA_NQ, NV = FOTSMC_PANDA_NV;

// The learnt arm, as the controller has it after a tick.
static void take_over(const fotsmc_panda_state &controller, pinocchio::Model &learned) {
    double links[10 * NV], armature[NV];
    fotsmc_panda_learned_model(&controller, links, armature);
    for (int i = 0; i < NV; i++) {
        const Dynamic parameters = Eigen::Map<const Dynamic>(links + 10 * i);
        learned.inertias[i + 1] = pinocchio::Inertia::FromDynamicParameters(parameters);
        learned.armature[i] = armature[i];
    }
}

int main(int argc, char **argv) {
    if (argc != 2) { return 2; }
    pinocchio::Model nominal;
    pinocchio::urdf::buildModel(argv[1], nominal);
    if (nominal.nq != NQ || nominal.nv != NV) {
        std::fprintf(stderr, "the model has %d joints, the controller %d\n", nominal.nv, NV);
        return 2;
    }
    pinocchio::Model learned = nominal, truth = nominal;
    for (auto &body : truth.inertias) { body.mass() *= 1.3; body.inertia() *= 1.3; }
    pinocchio::Data data(nominal), learned_data(learned), true_data(truth);

    static fotsmc_panda_state controller;
    fotsmc_panda_init(&controller);
    take_over(controller, learned);

    const double dt = FOTSMC_PANDA_DT;
    const Vector start = 0.5 * (nominal.lowerPositionLimit + nominal.upperPositionLimit);
    Vector q = start, v = Vector::Zero(NV), tau(NV);
    double error = 0.0, heaviest = 0.0;
    for (int k = 0; k < 8000; k++) {
        Vector q_d(NV), v_d(NV), a_d(NV);
        for (int i = 0; i < NV; i++) {
            const double w = 1.0 + 0.23 * i, size = 0.25, t = k * dt;
            q_d[i] = start[i] + size * (1.0 - std::cos(w * t));
            v_d[i] = size * w * std::sin(w * t);
            a_d[i] = size * w * w * std::cos(w * t);
        }

        // Every fourth tick it asks for the regressor of the nominal arm where it has been.
        Vector at_q(NQ), at_v(NV), at_a(NV);
        if (fotsmc_panda_regressor_due(&controller, at_q.data(), at_v.data(), at_a.data())) {
            const RowMajor regressor =
                pinocchio::computeJointTorqueRegressor(nominal, data, at_q, at_v, at_a);
            if (fotsmc_panda_give_regressor(&controller, regressor.data()) != FOTSMC_PANDA_OK) { return 1; }
        }

        // M and h are those of the learnt arm.
        pinocchio::crba(learned, learned_data, q);
        learned_data.M.triangularView<Eigen::StrictlyLower>() = learned_data.M.transpose();
        const RowMajor M = learned_data.M;
        const Vector h = pinocchio::nonLinearEffects(learned, learned_data, q, v);
        const int status = fotsmc_panda_update(&controller, q.data(), v.data(), q_d.data(), v_d.data(),
                                               a_d.data(), M.data(), h.data(), dt, tau.data());
        if (status != FOTSMC_PANDA_OK) { return 1; }
        take_over(controller, learned);

        Vector friction(NV);
        for (int i = 0; i < NV; i++) { friction[i] = 0.5 * v[i] + 0.5 * std::tanh(v[i] / 1e-3); }
        v += dt * pinocchio::aba(truth, true_data, q, v, Vector(tau - friction));
        q = pinocchio::integrate(nominal, q, Vector(dt * v));
        if (k >= 7000) { error = std::fmax(error, (q - q_d).cwiseAbs().maxCoeff()); }
    }
    for (int i = 1; i <= NV; i++) { heaviest += learned.inertias[i].mass() / nominal.inertias[i].mass() / NV; }
    std::printf("largest error in the last second: %.3g mrad; links %.2f times as heavy as in the file\n",
                1e3 * error, heaviest);
    return error < 1e-3 ? 0 : 1;
}
