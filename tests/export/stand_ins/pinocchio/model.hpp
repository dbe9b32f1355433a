// What the example uses of Pinocchio and Eigen, declared only: the real headers take minutes.
#pragma once
#include <cstddef>
#include <string>

namespace Eigen {
using Index = std::ptrdiff_t;
enum { StrictlyLower };
struct VectorXd {
    void resize(Index size);
    double *data();
    const double *data() const;
    double &operator[](Index index);
};
struct MatrixXd {
    template <int Part>
    struct View {
        View &operator=(const MatrixXd &other);
    };
    template <int Part>
    View<Part> triangularView();
    MatrixXd transpose() const;
    double *data();
};
}  // namespace Eigen
namespace pinocchio {
struct Model {
    int nq, nv;
};
struct Data {
    Data() = default;
    explicit Data(const Model &model);
    Eigen::MatrixXd M;
    Eigen::VectorXd nle, g;
};
const Eigen::MatrixXd &crba(const Model &, Data &, const Eigen::VectorXd &);
const Eigen::VectorXd &nonLinearEffects(
    const Model &, Data &, const Eigen::VectorXd &, const Eigen::VectorXd &);
const Eigen::VectorXd &computeGeneralizedGravity(const Model &, Data &, const Eigen::VectorXd &);
namespace urdf {
Model &buildModel(const std::string &file, Model &model);
}
}  // namespace pinocchio
