// Fluid: the grid's description and the loops of one step.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>

#include <tuple>

#include "check.hpp"
#include "rdpm/fluid/diffusion.hpp"
#include "rdpm/fluid/measures.hpp"
#include "rdpm/fluid/momentum.hpp"
#include "rdpm/fluid/projection.hpp"

namespace nb = nanobind;
using namespace rdpm;

namespace {

using Field = Array<double>;

double* field(const Grid& g, const Field& array, const char* name) {
    return checked(array, name, {g.nz() + 2, g.ny() + 2, g.nx() + 2});
}

VelocityArrays velocity(const Grid& g, const Field& u, const Field& v, const Field& w, const char* name) {
    const std::string n = name;
    return {field(g, u, (n + " u").c_str()), field(g, v, (n + " v").c_str()),
            field(g, w, (n + " w").c_str())};
}

void momentum_explicit(const Grid& g, const Field& u, const Field& v, const Field& w, const Field& ru,
                       const Field& rv, const Field& rw, const Field& p, double dt, double now, double then,
                       double nu, const std::array<double, 3>& force, const Field& scratch) {
    const auto q = velocity(g, u, v, w, "velocity"), stored = velocity(g, ru, rv, rw, "stored tendency");
    const double* pressure = field(g, p, "pressure");
    double* planes = checked(scratch, "scratch", {-1});
    if (scratch.size() < 9 * g.plane() * g.threads)
        throw std::invalid_argument("scratch: needs 9 planes a thread");
    nb::gil_scoped_release released;
    momentum<true>(g, q, stored, {}, pressure, {dt, now, then, nu, {force[0], force[1], force[2]}}, planes);
}

void momentum_rate(const Grid& g, const Field& u, const Field& v, const Field& w, const Field& ru,
                   const Field& rv, const Field& rw, const Field& mu, const Field& mv, const Field& mw,
                   const Field& p, double now, double then, double nu, const std::array<double, 3>& force) {
    const auto q = velocity(g, u, v, w, "velocity"), stored = velocity(g, ru, rv, rw, "stored tendency"),
               rate = velocity(g, mu, mv, mw, "rate");
    const double* pressure = field(g, p, "pressure");
    nb::gil_scoped_release released;
    momentum<false>(g, q, stored, rate, pressure, {0.0, now, then, nu, {force[0], force[1], force[2]}},
                    nullptr);
}

void diffuse_stabilised(const Grid& g, const Field& q, const Field& rate, int component, double dt, double nu,
                        int stages, const Field& scratch) {
    double* target = field(g, q, "velocity");
    double* source = field(g, rate, "rate");
    double* planes = checked(scratch, "scratch", {-1});
    if (stages < 2 || component < 0 || component > 2)
        throw std::invalid_argument("stages must be >= 2, component 0 to 2");
    if (scratch.size() < 3 * (stages - 2) * g.plane() * g.threads)
        throw std::invalid_argument("scratch: needs 3 (stages - 2) planes a thread");
    const auto coefficients = legendre_stages(stages, dt);
    nb::gil_scoped_release released;
    stabilised_diffusion(g, target, source, component, nu, coefficients, planes);
}

std::tuple<double, double> project(Projection& projection, const Grid& g, const Field& u, const Field& v,
                                   const Field& w, const Field& p, const Field& phi, double dt,
                                   double rotational) {
    const auto q = velocity(g, u, v, w, "velocity");
    double *pressure = field(g, p, "pressure"), *increment = field(g, phi, "pressure increment");
    nb::gil_scoped_release released;
    const FlowMeasures m = projection.project(q, pressure, increment, dt, rotational);
    return {m.cfl_rate, m.square_sum};
}

}  // namespace

void bind_fluid(nb::module_& module) {
    nb::class_<Grid>(module, "Grid", "Cells, spacings, boundaries and side speeds, as the loops read them.")
        .def(
            "__init__",
            [](Grid* g, const std::array<int, 3>& cells, const std::array<double, 3>& spacing,
               const std::array<int, 3>& boundary, const std::array<double, 18>& side_speed, int threads) {
                for (int d = 0; d < 3; ++d)
                    if (cells[d] < 4 || !(spacing[d] > 0.0) || boundary[d] < 0 || boundary[d] > 2)
                        throw std::invalid_argument(
                            "grid: at least 4 cells, spacing > 0, boundary 0 to 2 a direction");
                if (threads < 1) throw std::invalid_argument("grid: threads must be at least 1");
                new (g) Grid{cells, spacing, boundary, side_speed, threads};
            },
            nb::arg("cells"), nb::arg("spacing"), nb::arg("boundary"), nb::arg("side_speed"),
            nb::arg("threads"));
    nb::class_<Projection>(module, "Projection", "The streamed Poisson solve and the velocity's correction.")
        .def(nb::init<const Grid&>(), nb::arg("grid"))
        .def("project", &project)
        .def("solve",
             [](Projection& self, const Grid& g, const Field& phi) {
                 double* values = field(g, phi, "phi");
                 nb::gil_scoped_release released;
                 self.solve(values);
             })
        .def_prop_ro("bytes", &Projection::bytes);
    module.def("momentum_explicit", &momentum_explicit);
    module.def("momentum_rate", &momentum_rate);
    module.def("diffuse_stabilised", &diffuse_stabilised);
    module.def("fill_halo", [](const Grid& g, const Field& q, int location) {
        double* values = field(g, q, "field");
        nb::gil_scoped_release released;
        fill_halo(g, values, location);
    });
    module.def("largest_divergence", [](const Grid& g, const Field& u, const Field& v, const Field& w) {
        const auto q = velocity(g, u, v, w, "velocity");
        nb::gil_scoped_release released;
        return largest_divergence(g, q);
    });
    module.def("cell_values",
               [](const Grid& g, const Field& u, const Field& v, const Field& w, const Field& p,
                  double density, const Array<float>& vel, const Array<float>& pressure) {
                   const auto q = velocity(g, u, v, w, "velocity");
                   const double* values = field(g, p, "pressure");
                   float* out = checked(vel, "velocity out", {g.nz(), g.ny(), g.nx(), 3});
                   float* out_p = checked(pressure, "pressure out", {g.nz(), g.ny(), g.nx()});
                   nb::gil_scoped_release released;
                   cell_values(g, q, values, density, out, out_p);
               });
    module.def("build_info", [] {
        nb::dict info;
        info["compiler"] = __VERSION__;
#if defined(__AVX512F__)
        info["simd"] = "AVX-512";
#elif defined(__AVX2__)
        info["simd"] = "AVX2";
#elif defined(__ARM_NEON)
        info["simd"] = "NEON";
#else
        info["simd"] = "baseline";
#endif
        info["openmp"] = _OPENMP;
        return info;
    });
}
