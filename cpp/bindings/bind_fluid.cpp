// Fluid: the grid's description and the loops of one step.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>
#include <vector>

#include "check.hpp"
#include "rdpm/fluid/diffusion.hpp"
#include "rdpm/fluid/interfaces.hpp"
#include "rdpm/fluid/measures.hpp"
#include "rdpm/fluid/momentum.hpp"
#include "rdpm/fluid/projection.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace rdpm;

namespace {

using Triple = std::array<double, 3>;

void make_grid(Grid* g, const std::array<int, 3>& cells, const Triple& spacing,
               const std::array<int, 3>& boundary, const std::array<double, 18>& wall_velocity, int threads,
               int planes_below, int box_planes, const std::array<bool, 2>& joined) {
    double values = 1.0;
    for (int d = 0; d < 3; ++d) {
        require(cells[d] >= 4 && spacing[d] > 0.0 && boundary[d] >= 0 && boundary[d] <= 4,
                "grid: at least 4 cells, spacing > 0, boundary 0 to 4 a direction");
        require(cells[d] <= most_cells, "grid: at most 2^29 cells a direction");
        values *= cells[d] + 2.0;
    }
    require(values < 1e18, "grid: a field's size in bytes must be a 64-bit number");
    require(threads >= 1, "grid: threads must be at least 1");
    const bool is_slab = box_planes > 0;
    require(is_slab ? planes_below >= 0 && planes_below <= box_planes - cells[2] && (joined[0] || joined[1])
                    : planes_below == 0 && box_planes == 0 && !joined[0] && !joined[1],
            "grid: a slab lies within its box, and adjoins another one");
    new (g) Grid{cells, spacing, boundary, wall_velocity, threads, planes_below, box_planes, joined};
}

double* momentum_planes_of(const Grid& g, const InOut<double>& scratch) {
    require(
        static_cast<std::size_t>(scratch.rows("scratch", {-1})) >= momentum_scratch * g.plane() * g.threads,
        "scratch: needs 9 planes a thread");
    return scratch.checked("scratch", {-1});
}

void momentum_explicit(const Grid& g, const InOut<double>& u, const InOut<double>& v, const InOut<double>& w,
                       const InOut<double>& tendency_u, const InOut<double>& tendency_v,
                       const InOut<double>& tendency_w, const In<double>& p, double dt, double now,
                       double then, double nu, const Triple& force, const InOut<double>& scratch) {
    const VelocityArrays q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")},
        stored{field(g, tendency_u, "tendency_u"), field(g, tendency_v, "tendency_v"),
               field(g, tendency_w, "tendency_w")};
    const double* pressure = field(g, p, "p");
    double* planes = momentum_planes_of(g, scratch);
    nb::gil_scoped_release released;
    momentum<true>(g, q, stored, {}, pressure, {dt, now, then, nu, {force[0], force[1], force[2]}}, planes);
}

void momentum_rate(const Grid& g, const In<double>& u, const In<double>& v, const In<double>& w,
                   const InOut<double>& tendency_u, const InOut<double>& tendency_v,
                   const InOut<double>& tendency_w, const InOut<double>& rate_u, const InOut<double>& rate_v,
                   const InOut<double>& rate_w, const In<double>& p, double now, double then, double nu,
                   const Triple& force, const InOut<double>& scratch) {
    const VelocityView q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
    const VelocityArrays stored{field(g, tendency_u, "tendency_u"), field(g, tendency_v, "tendency_v"),
                                field(g, tendency_w, "tendency_w")},
        rate{field(g, rate_u, "rate_u"), field(g, rate_v, "rate_v"), field(g, rate_w, "rate_w")};
    const double* pressure = field(g, p, "p");
    double* planes = momentum_planes_of(g, scratch);
    nb::gil_scoped_release released;
    momentum<false>(g, q, stored, rate, pressure, {0.0, now, then, nu, {force[0], force[1], force[2]}},
                    planes);
}

void diffuse_stabilised(const Grid& g, const InOut<double>& velocity, const InOut<double>& rate,
                        int component, double dt, double nu, int stages, const InOut<double>& scratch,
                        const InOut<double>& below, const InOut<double>& above) {
    double *target = field(g, velocity, "velocity"), *source = field(g, rate, "rate");
    double* planes = scratch.checked("scratch", {-1});
    require(component >= 0 && component <= 2, "component: must be 0 to 2");
    require(stages >= 2 && stages <= most_stages, "stages: must be 2 to 10000");
    require(
        static_cast<std::size_t>(scratch.rows("scratch", {-1})) >= 3 * (stages - 2) * g.plane() * g.threads,
        "scratch: needs 3 (stages - 2) planes a thread");
    const auto beyond = [&](const InOut<double>& array, const char* name, bool is_open) {
        return array.checked(name, {is_open ? stages - 1 : 0, g.ny() + 2, g.nx() + 2});
    };
    const std::array<double*, 2> of_others{beyond(below, "below", g.joined[0]),
                                           beyond(above, "above", g.joined[1])};
    const auto coefficients = legendre_stages(stages, dt);
    nb::gil_scoped_release released;
    stabilised_diffusion(g, target, source, component, nu, coefficients, planes, of_others);
}

// A solver is of one grid: its arrays hold that many cells.
void require_same(const Grid& g, const Projection& projection) {
    require(g.is_like(projection.grid()), "grid: the projection was made for another one");
}

std::tuple<double, double> project(Projection& projection, const Grid& g, const InOut<double>& u,
                                   const InOut<double>& v, const InOut<double>& w, const InOut<double>& p,
                                   const InOut<double>& increment, double dt, double rotational) {
    require_same(g, projection);
    require(!g.is_slab(), "grid: must not be a slab");
    const VelocityArrays q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
    double *pressure = field(g, p, "p"), *phi = field(g, increment, "increment");
    nb::gil_scoped_release released;
    const FlowMeasures m = projection.project(q, pressure, phi, dt, rotational);
    return {m.cfl_rate, m.square_sum};
}

void require_slab(const Grid& g, const Projection& projection) {
    require_same(g, projection);
    require(g.is_slab(), "grid: must be a slab");
}

std::array<double*, 2> ends_of(const Grid& g, const InOut<double>& below, const InOut<double>& above) {
    return {below.checked("below", {g.ny(), g.nx()}), above.checked("above", {g.ny(), g.nx()})};
}

void project_inwards(Projection& projection, const Grid& g, const InOut<double>& u, const InOut<double>& v,
                     const InOut<double>& w, const InOut<double>& increment, double dt,
                     const InOut<double>& below, const InOut<double>& above) {
    require_slab(g, projection);
    const VelocityArrays q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
    double* phi = field(g, increment, "increment");
    const auto ends = ends_of(g, below, above);
    nb::gil_scoped_release released;
    projection.inwards(q, phi, dt, ends);
}

void project_outwards(Projection& projection, const Grid& g, const InOut<double>& u, const InOut<double>& v,
                      const InOut<double>& w, const InOut<double>& p, const InOut<double>& increment,
                      double dt, double rotational, const InOut<double>& below, const InOut<double>& above) {
    require_slab(g, projection);
    const VelocityArrays q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
    double *pressure = field(g, p, "p"), *phi = field(g, increment, "increment");
    const auto ends = ends_of(g, below, above);
    nb::gil_scoped_release released;
    projection.outwards(q, pressure, phi, dt, rotational, ends);
}

void project_finish(Projection& projection, const Grid& g, const InOut<double>& u, const InOut<double>& v,
                    const InOut<double>& w, const InOut<double>& p, const InOut<double>& increment,
                    double dt) {
    require_slab(g, projection);
    const VelocityArrays q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
    double *pressure = field(g, p, "p"), *phi = field(g, increment, "increment");
    nb::gil_scoped_release released;
    projection.finish(q, pressure, phi, dt);
}

std::tuple<double, double> project_measures(Projection& projection, const Grid& g, const In<double>& u,
                                            const In<double>& v, const In<double>& w) {
    require_slab(g, projection);
    const VelocityView q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
    nb::gil_scoped_release released;
    const FlowMeasures m = projection.measure_flow(q);
    return {m.cfl_rate, m.square_sum};
}

// The interfaces between slabs of so many planes each, of the modes from `first` on.
void make_interfaces(Interfaces* made, const Grid& g, const std::vector<int>& planes, int first, int count) {
    require(planes.size() >= 2, "planes: at least two slabs");
    for (const int n : planes) require(n >= 1, "planes: at least 1 a slab");
    const std::int64_t modes = static_cast<std::int64_t>(g.nx()) * g.ny();
    require(first >= 0 && count >= 0 && first + static_cast<std::int64_t>(count) <= modes,
            "first, count: must be of modes of a plane");
    const auto x = mode_eigenvalues(g.nx(), g.spacing[0], g.boundary[0] == periodic),
               y = mode_eigenvalues(g.ny(), g.spacing[1], g.boundary[1] == periodic);
    const double square = g.spacing[2] * g.spacing[2];
    std::vector<double> m(count);
    for (int o = 0; o < count; ++o) m[o] = (x[(first + o) % g.nx()] + y[(first + o) / g.nx()]) * square;
    new (made) Interfaces(m, planes, g.boundary[2] == periodic);
}

void solve_interfaces(const Interfaces& interfaces, const InOut<double>& ends, int threads) {
    double* values = ends.checked("ends", {static_cast<std::int64_t>(interfaces.slabs()), 2,
                                           static_cast<std::int64_t>(interfaces.modes())});
    require(threads >= 1, "threads: must be at least 1");
    nb::gil_scoped_release released;
    interfaces.solve(values, threads);
}

void solve(Projection& projection, const Grid& g, const InOut<double>& phi) {
    require_same(g, projection);
    require(!g.is_slab(), "grid: must not be a slab");
    double* values = field(g, phi, "phi");
    nb::gil_scoped_release released;
    projection.solve(values);
}

void fill_field_halo(const Grid& g, const InOut<double>& values, int location) {
    double* q = field(g, values, "field");
    require(location >= face_x && location <= centre, "location: must be 0 to 3");
    nb::gil_scoped_release released;
    fill_halo(g, q, location);
}

double divergence(const Grid& g, const In<double>& u, const In<double>& v, const In<double>& w) {
    const VelocityView q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
    nb::gil_scoped_release released;
    return largest_divergence(g, q);
}

void values_at_centres(const Grid& g, const In<double>& u, const In<double>& v, const In<double>& w,
                       const In<double>& p, double density, const InOut<float>& velocity,
                       const InOut<float>& pressure) {
    const VelocityView q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
    const double* values = field(g, p, "p");
    float* out = velocity.checked("velocity", {g.nz(), g.ny(), g.nx(), 3});
    float* out_p = pressure.checked("pressure", {g.nz(), g.ny(), g.nx()});
    nb::gil_scoped_release released;
    cell_values(g, q, values, density, out, out_p);
}

nb::typed<nb::dict, nb::str, nb::object> build_info() {
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
    info["level"] = RDPM_LEVEL;
    info["openmp"] = _OPENMP;
    return nb::borrow<nb::typed<nb::dict, nb::str, nb::object>>(info);
}

}  // namespace

void bind_fluid(nb::module_& module) {
    nb::class_<Grid>(module, "Grid", "Cells, spacings, boundaries and side speeds, as the loops read them.")
        .def("__init__", &make_grid, "cells"_a, "spacing"_a, "boundary"_a, "wall_velocity"_a, "threads"_a,
             "planes_below"_a, "box_planes"_a, "joined"_a);
    nb::class_<Projection>(module, "Projection", "The streamed Poisson solve and the velocity's correction.")
        .def(nb::init<const Grid&>(), "grid"_a)
        .def("project", &project, "grid"_a, "u"_a, "v"_a, "w"_a, "p"_a, "increment"_a, "dt"_a, "rotational"_a)
        .def("inwards", &project_inwards, "grid"_a, "u"_a, "v"_a, "w"_a, "increment"_a, "dt"_a, "below"_a,
             "above"_a)
        .def("outwards", &project_outwards, "grid"_a, "u"_a, "v"_a, "w"_a, "p"_a, "increment"_a, "dt"_a,
             "rotational"_a, "below"_a, "above"_a)
        .def("finish", &project_finish, "grid"_a, "u"_a, "v"_a, "w"_a, "p"_a, "increment"_a, "dt"_a)
        .def("measures", &project_measures, "grid"_a, "u"_a, "v"_a, "w"_a)
        .def("solve", &solve, "grid"_a, "phi"_a)
        .def_prop_ro("bytes", &Projection::bytes);
    nb::class_<Interfaces>(module, "Interfaces", "What slabs have in common in the Poisson solve.")
        .def("__init__", &make_interfaces, "grid"_a, "planes"_a, "first"_a, "count"_a)
        .def("solve", &solve_interfaces, "ends"_a, "threads"_a)
        .def_prop_ro("bytes", &Interfaces::bytes);
    module.def("momentum_explicit", &momentum_explicit, "grid"_a, "u"_a, "v"_a, "w"_a, "tendency_u"_a,
               "tendency_v"_a, "tendency_w"_a, "p"_a, "dt"_a, "now"_a, "then"_a, "nu"_a, "force"_a,
               "scratch"_a);
    module.def("momentum_rate", &momentum_rate, "grid"_a, "u"_a, "v"_a, "w"_a, "tendency_u"_a, "tendency_v"_a,
               "tendency_w"_a, "rate_u"_a, "rate_v"_a, "rate_w"_a, "p"_a, "now"_a, "then"_a, "nu"_a,
               "force"_a, "scratch"_a);
    module.def("diffuse_stabilised", &diffuse_stabilised, "grid"_a, "velocity"_a, "rate"_a, "component"_a,
               "dt"_a, "nu"_a, "stages"_a, "scratch"_a, "below"_a, "above"_a);
    module.def("fill_halo", &fill_field_halo, "grid"_a, "field"_a, "location"_a);
    module.def("largest_divergence", &divergence, "grid"_a, "u"_a, "v"_a, "w"_a);
    module.def("cell_values", &values_at_centres, "grid"_a, "u"_a, "v"_a, "w"_a, "p"_a, "density"_a,
               "velocity"_a, "pressure"_a);
    module.def("build_info", &build_info);
}
