// Bodies in the fluid: stencils of the markers, interpolation, spreading, sums over markers and over the
// inner fluid.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>

#include <array>
#include <limits>

#include "check.hpp"
#include "rdpm/particles/close_surfaces.hpp"
#include "rdpm/particles/immersed_boundary.hpp"
#include "rdpm/particles/inner_fluid.hpp"
#include "rdpm/particles/marker_sums.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace rdpm;

namespace {

// Markers first[b] to first[b + 1] belong to body b. Both numbers stay within 32 bits in all that a body or a
// marker has.
struct Owners {
    const std::int32_t* first;
    int bodies, markers;

    explicit Owners(const In<std::int32_t>& array) : first(array.checked("first", {-1})) {
        constexpr int most = std::numeric_limits<int>::max();
        const std::int64_t rows = array.rows("first", {-1});
        require(rows >= 1 && rows <= most / 10, "first: needs one entry more than bodies, at most 214748364");
        bodies = static_cast<int>(rows) - 1;
        require(first[0] == 0, "first: must begin with 0");
        for (int b = 0; b < bodies; ++b) require(first[b] <= first[b + 1], "first: must not fall");
        markers = first[bodies];
        require(markers <= most / 3, "first: at most 715827882 markers");
    }
};

void require_threads(int threads) {
    require(threads >= 1, "threads: must be at least 1");
}

// The stencils of all markers, kept between calls.
class Markers {
  public:
    Markers(const Grid& g, const In<std::int32_t>& first) : Markers(g, Owners(first)) {}

    int count() const { return set_.count(); }

    void place_at(const Grid& g, const In<double>& position) {
        require_same(g);
        const double* x = position.checked("position", {set_.count(), 3});
        nb::gil_scoped_release released;
        place(g, x, set_);
    }
    void interpolate_to(const Grid& g, const In<double>& u, const In<double>& v, const In<double>& w,
                        const InOut<double>& velocity) const {
        require_placed(g);
        const VelocityView q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
        double* out = velocity.checked("velocity", {set_.count(), 3});
        nb::gil_scoped_release released;
        interpolate(g, q, set_, out);
    }
    void spread_from(const Grid& g, const InOut<double>& u, const InOut<double>& v, const InOut<double>& w,
                     const In<double>& value, const In<double>& volume, double factor) const {
        require_placed(g);
        const VelocityArrays q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
        const double* values = value.checked("value", {set_.count(), 3});
        const double* volumes = volume.checked("volume", {set_.count()});
        nb::gil_scoped_release released;
        spread(g, q, set_, values, volumes, factor);
    }
    void inner_sums_of(const Grid& g, const In<double>& u, const In<double>& v, const In<double>& w,
                       const In<double>& position, const In<double>& radius,
                       const InOut<double>& sums) const {
        require_placed(g);
        const VelocityView q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
        const int bodies = set_.bodies();
        const double* x = position.checked("position", {bodies, 3});
        const double* a = radius.checked("radius", {bodies});
        double* out = sums.checked("sums", {bodies, 12});
        for (int b = 0; b < bodies; ++b)
            require(is_within_a_period(g, x + 3 * b, a[b]),
                    "position, radius: a body is not finite, or reaches more than a period beyond the box");
        nb::gil_scoped_release released;
        inner_sums(g, q, set_, x, a, out);
    }

  private:
    Markers(const Grid& g, const Owners& of) : set_(g, of.first, of.bodies) {}
    void require_same(const Grid& g) const {
        require(g.is_like(set_.grid), "grid: the markers were made for another one");
    }
    void require_placed(const Grid& g) const {
        require_same(g);
        require(set_.is_placed, "markers: call place first");
    }

    StencilSet set_;
};

void sum_values(const In<std::int32_t>& first, const In<double>& arm, const In<double>& volume,
                const In<double>& value, int threads, const InOut<double>& sums) {
    const Owners of(first);
    const int n = of.markers;
    const double *r = arm.checked("arm", {n, 3}), *dv = volume.checked("volume", {n});
    const double* x = value.checked("value", {n, 3});
    double* out = sums.checked("sums", {of.bodies, 6});
    require_threads(threads);
    nb::gil_scoped_release released;
    sum_over_markers(of.bodies, of.first, r, dv, x, threads, out);
}

void move(const In<std::int32_t>& first, const In<double>& orientation, const In<double>& centre,
          const In<double>& body_arm, const In<double>& body_force, int threads, const InOut<double>& arm,
          const InOut<double>& position, const InOut<double>& force) {
    const Owners of(first);
    const int n = of.markers;
    const double* o = orientation.checked("orientation", {of.bodies, 4});
    const double* x = centre.checked("centre", {of.bodies, 3});
    const double* r_body = body_arm.checked("body_arm", {n, 3});
    const double* f_body = body_force.checked("body_force", {n, 3});
    double *r = arm.checked("arm", {n, 3}), *at = position.checked("position", {n, 3});
    double* f = force.checked("force", {n, 3});
    require_threads(threads);
    nb::gil_scoped_release released;
    move_markers(of.bodies, of.first, o, x, r_body, f_body, threads, r, at, f);
}

void store(const In<std::int32_t>& first, const In<double>& orientation, double share, int threads,
           const InOut<double>& force, const InOut<double>& body_force) {
    const Owners of(first);
    const double* o = orientation.checked("orientation", {of.bodies, 4});
    double* f = force.checked("force", {of.markers, 3});
    double* f_body = body_force.checked("body_force", {of.markers, 3});
    require_threads(threads);
    nb::gil_scoped_release released;
    store_forces(of.bodies, of.first, o, share, threads, f, f_body);
}

void change_to_rigid(const In<std::int32_t>& first, const In<double>& arm, const In<double>& volume,
                     const In<double>& velocity, const In<double>& angular_velocity, double inverse_dt,
                     int threads, const InOut<double>& change, const InOut<double>& force,
                     const InOut<double>& sums) {
    const Owners of(first);
    const int n = of.markers;
    const double *r = arm.checked("arm", {n, 3}), *dv = volume.checked("volume", {n});
    const double* v = velocity.checked("velocity", {of.bodies, 3});
    const double* o = angular_velocity.checked("angular_velocity", {of.bodies, 3});
    double *c = change.checked("change", {n, 3}), *f = force.checked("force", {n, 3});
    double* out = sums.checked("sums", {of.bodies, 7});
    require_threads(threads);
    nb::gil_scoped_release released;
    rigid_change(of.bodies, of.first, r, dv, v, o, inverse_dt, threads, c, f, out);
}

void moments_of(const In<std::int32_t>& first, const In<double>& arm, const In<double>& volume, int threads,
                const InOut<double>& moments) {
    const Owners of(first);
    const double* r = arm.checked("arm", {of.markers, 3});
    const double* dv = volume.checked("volume", {of.markers});
    double* out = moments.checked("moments", {of.bodies, 10});
    require_threads(threads);
    nb::gil_scoped_release released;
    marker_moments(of.bodies, of.first, r, dv, threads, out);
}

void exclude(const std::array<double, 3>& size, const std::array<bool, 3>& is_periodic,
             const std::array<bool, 3>& is_solid, const std::array<double, 4>& exclusion,
             const In<std::int32_t>& pairs, const In<std::int32_t>& first, const In<double>& position,
             const In<double>& centre, const In<double>& radius, const In<double>& full_volume, int threads,
             const InOut<double>& volume) {
    const Owners of(first);
    const int n = of.markers;
    const std::int32_t* ij = pairs.checked("pairs", {-1, 2});
    const std::int64_t count = pairs.rows("pairs", {-1, 2});
    require(count <= std::numeric_limits<int>::max() / 2, "pairs: at most 1073741823");
    for (std::int64_t p = 0; p < count; ++p)
        require(ij[2 * p] >= 0 && ij[2 * p] < of.bodies && ij[2 * p + 1] >= -6 && ij[2 * p + 1] < of.bodies,
                "pairs: ids must be of bodies, the second one of a body or a side, -6 to -1");
    const double* x = position.checked("position", {n, 3});
    const double* c = centre.checked("centre", {of.bodies, 3});
    const double* a = radius.checked("radius", {of.bodies});
    const double* full = full_volume.checked("full_volume", {n});
    double* out = volume.checked("volume", {n});
    require_threads(threads);
    const Surroundings around{{size[0], size[1], size[2]},
                              {is_periodic[0], is_periodic[1], is_periodic[2]},
                              {is_solid[0], is_solid[1], is_solid[2]},
                              ij,
                              static_cast<int>(count)};
    nb::gil_scoped_release released;
    exclude_markers(around, {exclusion[0], exclusion[1], exclusion[2], exclusion[3]}, of.bodies, of.first, x,
                    c, a, full, threads, out);
}

}  // namespace

void bind_particles(nb::module_& module) {
    nb::class_<Markers>(module, "Markers", "Stencils of the markers at their present places.")
        .def(nb::init<const Grid&, const In<std::int32_t>&>(), "grid"_a, "first"_a)
        .def("place", &Markers::place_at, "grid"_a, "position"_a)
        .def("interpolate", &Markers::interpolate_to, "grid"_a, "u"_a, "v"_a, "w"_a, "velocity"_a)
        .def("spread", &Markers::spread_from, "grid"_a, "u"_a, "v"_a, "w"_a, "value"_a, "volume"_a,
             "factor"_a)
        .def("inner_sums", &Markers::inner_sums_of, "grid"_a, "u"_a, "v"_a, "w"_a, "position"_a, "radius"_a,
             "sums"_a)
        .def_prop_ro("count", &Markers::count);
    module.def("sum_over_markers", &sum_values, "first"_a, "arm"_a, "volume"_a, "value"_a, "threads"_a,
               "sums"_a);
    module.def("move_markers", &move, "first"_a, "orientation"_a, "centre"_a, "body_arm"_a, "body_force"_a,
               "threads"_a, "arm"_a, "position"_a, "force"_a);
    module.def("store_forces", &store, "first"_a, "orientation"_a, "share"_a, "threads"_a, "force"_a,
               "body_force"_a);
    module.def("rigid_change", &change_to_rigid, "first"_a, "arm"_a, "volume"_a, "velocity"_a,
               "angular_velocity"_a, "inverse_dt"_a, "threads"_a, "change"_a, "force"_a, "sums"_a);
    module.def("marker_moments", &moments_of, "first"_a, "arm"_a, "volume"_a, "threads"_a, "moments"_a);
    module.def("exclude_markers", &exclude, "size"_a, "is_periodic"_a, "is_solid"_a, "exclusion"_a, "pairs"_a,
               "first"_a, "position"_a, "centre"_a, "radius"_a, "full_volume"_a, "threads"_a, "volume"_a);
}
