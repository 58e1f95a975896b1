// Contacts: neighbours, sub-steps, the end of a step. Python owns every array; rooms of scratch come from
// there too.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "check.hpp"
#include "rdpm/contacts/adaptive.hpp"
#include "rdpm/contacts/events.hpp"
#include "rdpm/contacts/hertz.hpp"
#include "rdpm/contacts/motion.hpp"
#include "rdpm/contacts/neighbours.hpp"
#include "rdpm/contacts/repulsive.hpp"
#include "rdpm/contacts/separate.hpp"
#include "rdpm/contacts/soft_sphere.hpp"
#include "rdpm/contacts/substeps.hpp"

namespace nb = nanobind;
using rdpm::In;
using rdpm::InOut;
namespace contacts = rdpm::contacts;

namespace {

using Reals = In<double>;

// box: rows size, period (0: not periodic, below 0: open); six rows of wall velocities; five rows a wall within
// the box.
contacts::Box make_box(const Reals& array) {
    static_assert(sizeof(contacts::InnerWall) == 15 * sizeof(double));
    const std::int64_t rows = array.rows("box", {-1, 3});
    rdpm::require(rows >= 8 && rows % 5 == 3 && rows < 5000, "box: needs 8 rows, and 5 more a wall");
    const double* b = array.checked("box", {rows, 3});
    contacts::Box box{};
    for (int d = 0; d < 3; ++d) {
        box.size[d] = b[d];
        box.is_open[d] = b[3 + d] < 0;
        box.period[d] = std::max(0.0, b[3 + d]);
        box.inverse_period[d] = b[3 + d] > 0 ? 1 / b[3 + d] : 0;
    }
    box.wall_velocity = b + 6;
    box.walls = reinterpret_cast<const contacts::InnerWall*>(b + 24);
    box.inner_walls = static_cast<int>((rows - 8) / 5);
    return box;
}

std::int64_t find_pairs(const Reals& box, const Reals& position, const Reals& velocity, const Reals& force,
                        const Reals& radius, const Reals& inverse_mass, double dt, double margin,
                        const InOut<std::int32_t>& cell_start, const InOut<std::int32_t>& cell_order,
                        const InOut<std::int32_t>& pairs) {
    const std::int64_t n = position.rows("position", {-1, 3});
    const contacts::Box b = make_box(box);
    const double *x = position.checked("position", {n, 3}), *v = velocity.checked("velocity", {n, 3});
    const double *f = force.checked("force", {n, 3}), *a = radius.checked("radius", {n});
    const double* m = inverse_mass.checked("inverse_mass", {n});
    std::int32_t* start = cell_start.checked("cell_start", {contacts::CellList::most_cells(n) + 1});
    std::int32_t* order = cell_order.checked("cell_order", {n});
    std::int32_t* out = pairs.checked("pairs", {-1, 2});
    const auto capacity = pairs.rows("pairs", {-1, 2});
    nb::gil_scoped_release unlocked;
    const double range = margin + contacts::travel(v, f, m, n, dt);
    return contacts::find_pairs(b, x, a, m, n, range, start, order, out, capacity);
}

void nearest_surfaces(const Reals& box, const Reals& position, const Reals& radius,
                      const InOut<std::int32_t>& cell_start, const InOut<std::int32_t>& cell_order,
                      const InOut<double>& gap, const InOut<std::int64_t>& neighbour) {
    const std::int64_t n = position.rows("position", {-1, 3});
    const contacts::Box b = make_box(box);
    const double *x = position.checked("position", {n, 3}), *a = radius.checked("radius", {n});
    std::int32_t* start = cell_start.checked("cell_start", {contacts::CellList::most_cells(n) + 1});
    std::int32_t* order = cell_order.checked("cell_order", {n});
    double* g = gap.checked("gap", {n});
    std::int64_t* j = neighbour.checked("neighbour", {n});
    nb::gil_scoped_release unlocked;
    contacts::nearest_surfaces(b, x, a, n, start, order, g, j);
}

// Rows that cross the border are bytes here; Python compared their dtypes with these structs at import.
using Bytes = InOut<std::uint8_t>;
using ConstBytes = In<std::uint8_t>;

// A struct's members are read where they lie, so the bytes begin as its values must.
template <class Byte>
Byte* checked_bytes(const rdpm::ArrayArgument<Byte>& array, const char* name, std::int64_t n,
                    std::size_t size) {
    Byte* data = array.checked(name, {n, static_cast<std::int64_t>(size)});
    if (reinterpret_cast<std::uintptr_t>(data) % alignof(double) != 0)
        throw std::invalid_argument(std::string(name) + ": rows must be aligned as doubles");
    return data;
}
template <class Row>
Row* checked_rows(const Bytes& array, const char* name, std::int64_t n) {
    return reinterpret_cast<Row*>(checked_bytes(array, name, n, sizeof(Row)));
}
template <class Row>
const Row* checked_rows(const ConstBytes& array, const char* name, std::int64_t n) {
    return reinterpret_cast<const Row*>(checked_bytes(array, name, n, sizeof(Row)));
}

using Facts = nb::typed<nb::dict, nb::str, nb::any>;

Facts layout_dict(const contacts::Layout& layout) {
    nb::list fields;
    for (std::size_t k = 0; k < layout.count; ++k) {
        const contacts::Field& f = layout.fields[k];
        fields.append(nb::make_tuple(f.name, f.offset, f.count, std::string(1, f.kind)));
    }
    nb::dict result;
    result["fields"] = fields;
    result["size"] = layout.size;
    return nb::borrow<Facts>(result);
}

Facts contact_layouts() {
    nb::dict result;
    result["state"] = layout_dict(contacts::layout_of<contacts::ContactState>(contacts::state_fields));
    result["finished"] = layout_dict(contacts::layout_of<contacts::Finished>(contacts::finished_fields));
    result["lubrication"] =
        layout_dict(contacts::layout_of<contacts::LubricationRow>(contacts::lubrication_fields));
    return nb::borrow<Facts>(result);
}

constexpr contacts::Kernel soft_sphere = contacts::kernel_of<contacts::SoftSphere>();
constexpr contacts::Kernel adaptive = contacts::kernel_of<contacts::AdaptiveCollisionTime>();
constexpr contacts::Kernel hertz = contacts::kernel_of<contacts::Hertz>();
constexpr contacts::Kernel repulsive = contacts::kernel_of<contacts::Repulsive>();

const contacts::Kernel& kernel_at(std::uintptr_t address) {
    const auto& kernel = *reinterpret_cast<const contacts::Kernel*>(address);
    if (kernel.task_size != sizeof(contacts::SubstepTask))
        throw std::invalid_argument("contact kernel: was compiled against other headers");
    return kernel;
}

// Ids of bodies.
const std::int32_t* checked_bodies(const In<std::int32_t>& array, const char* name, std::int64_t count,
                                   std::int64_t bodies) {
    const std::int32_t* id = array.checked(name, {-1});
    for (std::int64_t k = 0; k < count; ++k)
        if (id[k] < 0 || id[k] >= bodies)
            throw std::invalid_argument(std::string(name) + ": id " + std::to_string(id[k]) + " is no body");
    return id;
}

// Ids of pairs; the second may be a wall of the box.
const std::int32_t* checked_pairs(const In<std::int32_t>& array, const char* name, std::int64_t count,
                                  std::int64_t bodies, const contacts::Box& box) {
    const std::int32_t* id = array.checked(name, {count, 2});
    for (std::int64_t k = 0; k < 2 * count; ++k) {
        const std::int64_t wall = -1 - static_cast<std::int64_t>(id[k]);
        const bool is_wall = k % 2 == 1 && wall != contacts::kFaces &&
                             wall < contacts::kFirstInner + static_cast<std::int64_t>(box.inner_walls);
        if (id[k] >= bodies || (id[k] < 0 && !is_wall))
            throw std::invalid_argument(std::string(name) + ": id " + std::to_string(id[k]) +
                                        " is no body and no wall");
    }
    return id;
}

std::tuple<std::int64_t, std::int64_t, std::int64_t, double, double> run_substeps(
    const contacts::Kernel& kernel, const Reals& box, const InOut<double>& position,
    const InOut<double>& velocity, const InOut<double>& angular_velocity, const InOut<double>& rotation,
    const Reals& velocity_increment, const Reals& angular_increment, const Reals& inverse_mass,
    const Reals& inverse_moment, const Reals& radius, const InOut<double>& impulse,
    const InOut<double>& angular_impulse, const InOut<double>& contact_impulse,
    const In<std::int32_t>& active, const In<std::int32_t>& pairs, const ConstBytes& parameters,
    const ConstBytes& lubrication, const Bytes& state, const Bytes& history, const Bytes& finished,
    double time, double h, double overlap_limit, std::int64_t first, std::int64_t last) {
    const auto n = position.rows("position", {-1, 3});
    const auto m = pairs.rows("pairs", {-1, 2});
    const auto actives = active.rows("active", {-1});
    const contacts::BodyArrays bodies{position.checked("position", {n, 3}),
                                      velocity.checked("velocity", {n, 3}),
                                      angular_velocity.checked("angular_velocity", {n, 3}),
                                      rotation.checked("rotation", {n, 3}),
                                      velocity_increment.checked("velocity_increment", {n, 3}),
                                      angular_increment.checked("angular_increment", {n, 3}),
                                      inverse_mass.checked("inverse_mass", {n}),
                                      inverse_moment.checked("inverse_moment", {n}),
                                      radius.checked("radius", {n}),
                                      impulse.checked("impulse", {n, 3}),
                                      angular_impulse.checked("angular_impulse", {n, 3}),
                                      contact_impulse.checked("contact_impulse", {n, 3})};
    const bool is_wet = lubrication.rows("lubrication", {-1, sizeof(contacts::LubricationRow)}) > 0;
    const contacts::PairArrays rows_of_pairs{
        checked_pairs(pairs, "pairs", m, n, make_box(box)),
        checked_bytes(parameters, "parameters", m, kernel.parameters.size),
        is_wet ? checked_rows<contacts::LubricationRow>(lubrication, "lubrication", m) : nullptr,
        checked_rows<contacts::ContactState>(state, "state", m),
        checked_bytes(history, "history", m, kernel.history.size),
        m};
    const contacts::SubstepTask task{bodies,
                                     make_box(box),
                                     checked_bodies(active, "active", actives, n),
                                     actives,
                                     rows_of_pairs,
                                     checked_rows<contacts::Finished>(finished, "finished", -1),
                                     finished.rows("finished", {-1, sizeof(contacts::Finished)}),
                                     time,
                                     h,
                                     overlap_limit,
                                     first,
                                     last};
    nb::gil_scoped_release unlocked;
    const contacts::Progress p = kernel.run(task);
    return {p.next, p.finished, p.failed, p.min_gap, p.max_overlap};
}

Facts hard_sphere_layouts() {
    nb::dict result;
    result["parameters"] = layout_dict(
        contacts::layout_of<contacts::HardSphere::Parameters>(contacts::HardSphere::parameter_fields));
    result["history"] =
        layout_dict(contacts::layout_of<contacts::HardSphere::History>(contacts::HardSphere::history_fields));
    return nb::borrow<Facts>(result);
}

contacts::BodyArrays body_arrays(const InOut<double>& position, const InOut<double>& velocity,
                                 const InOut<double>& angular_velocity, const InOut<double>& rotation,
                                 const Reals& acceleration, const Reals& angular_acceleration,
                                 const Reals& inverse_mass, const Reals& inverse_moment, const Reals& radius,
                                 const InOut<double>& impulse, const InOut<double>& angular_impulse,
                                 const InOut<double>& contact_impulse, std::int64_t n) {
    return {position.checked("position", {n, 3}),
            velocity.checked("velocity", {n, 3}),
            angular_velocity.checked("angular_velocity", {n, 3}),
            rotation.checked("rotation", {n, 3}),
            acceleration.checked("acceleration", {n, 3}),
            angular_acceleration.checked("angular_acceleration", {n, 3}),
            inverse_mass.checked("inverse_mass", {n}),
            inverse_moment.checked("inverse_moment", {n}),
            radius.checked("radius", {n}),
            impulse.checked("impulse", {n, 3}),
            angular_impulse.checked("angular_impulse", {n, 3}),
            contact_impulse.checked("contact_impulse", {n, 3})};
}

// Pairs of each body, in their order.
struct Incidence {
    std::vector<std::int32_t> first, pairs;

    Incidence(const std::int32_t* ids, std::int64_t m, std::int64_t n)
        : first(static_cast<std::size_t>(n) + 1), pairs(static_cast<std::size_t>(2 * m)) {
        const auto bodies = [&](std::int64_t k, auto&& visit) {
            for (int side = 0; side < 2; ++side)
                if (ids[2 * k + side] >= 0) visit(static_cast<std::size_t>(ids[2 * k + side]));
        };
        for (std::int64_t k = 0; k < m; ++k) bodies(k, [&](std::size_t b) { ++first[b + 1]; });
        for (std::size_t b = 1; b < first.size(); ++b) first[b] += first[b - 1];
        std::vector<std::int32_t> at(first.begin(), first.end() - 1);
        for (std::int64_t k = 0; k < m; ++k)
            bodies(k, [&](std::size_t b) {
                pairs[static_cast<std::size_t>(at[b]++)] = static_cast<std::int32_t>(k);
            });
    }
};

std::tuple<double, std::int64_t, std::int64_t, std::int64_t, std::int64_t> run_events(
    const Reals& box, const InOut<double>& position, const InOut<double>& velocity,
    const InOut<double>& angular_velocity, const InOut<double>& rotation, const Reals& acceleration,
    const Reals& angular_acceleration, const Reals& inverse_mass, const Reals& inverse_moment,
    const Reals& radius, const InOut<double>& impulse, const InOut<double>& angular_impulse,
    const InOut<double>& contact_impulse, const In<std::int32_t>& active, const In<std::int32_t>& pairs,
    const ConstBytes& parameters, const ConstBytes& lubrication, const Bytes& state, const Bytes& history,
    const Bytes& finished, const InOut<std::int64_t>& events, double start, double length, double rest_speed,
    double quiet, std::int64_t most_events, bool is_new) {
    const auto n = position.rows("position", {-1, 3});
    const auto m = pairs.rows("pairs", {-1, 2});
    const auto actives = active.rows("active", {-1});
    const bool is_wet = lubrication.rows("lubrication", {-1, sizeof(contacts::LubricationRow)}) > 0;
    const std::int32_t* ids = checked_pairs(pairs, "pairs", m, n, make_box(box));
    const contacts::PairArrays rows_of_pairs{
        ids,
        checked_rows<contacts::HardSphere::Parameters>(parameters, "parameters", m),
        is_wet ? checked_rows<contacts::LubricationRow>(lubrication, "lubrication", m) : nullptr,
        checked_rows<contacts::ContactState>(state, "state", m),
        checked_rows<contacts::HardSphere::History>(history, "history", m),
        m};
    const contacts::BodyArrays bodies =
        body_arrays(position, velocity, angular_velocity, rotation, acceleration, angular_acceleration,
                    inverse_mass, inverse_moment, radius, impulse, angular_impulse, contact_impulse, n);
    const std::int32_t* moved = checked_bodies(active, "active", actives, n);
    auto* done = checked_rows<contacts::Finished>(finished, "finished", -1);
    const auto capacity = finished.rows("finished", {-1, sizeof(contacts::Finished)});
    std::int64_t* counts = events.checked("events", {m});
    rdpm::require(capacity > m + 2, "finished: needs three rows more than there are pairs");
    const contacts::Box b = make_box(box);
    nb::gil_scoped_release unlocked;
    const Incidence incidence(ids, m, n);
    const auto size = static_cast<std::size_t>(m), count = static_cast<std::size_t>(n);
    std::vector<contacts::BodyWork> body_work(count);
    std::vector<contacts::PairWork> pair_work(size);
    std::vector<double> due(size);
    std::vector<std::int32_t> tree(static_cast<std::size_t>(2 * contacts::Schedule::leaves(m)));
    std::vector<std::int32_t> cluster(size), cluster_bodies(count);
    std::vector<std::uint8_t> is_marked(size), is_body_marked(count);
    const contacts::EventTask task{bodies,
                                   b,
                                   moved,
                                   actives,
                                   rows_of_pairs,
                                   done,
                                   capacity,
                                   incidence.first.data(),
                                   incidence.pairs.data(),
                                   body_work.data(),
                                   pair_work.data(),
                                   due.data(),
                                   tree.data(),
                                   cluster.data(),
                                   cluster_bodies.data(),
                                   is_marked.data(),
                                   is_body_marked.data(),
                                   counts,
                                   start,
                                   length,
                                   rest_speed,
                                   quiet,
                                   most_events,
                                   is_new};
    const contacts::Events e = contacts::EventLoop(task).run();
    return {e.reached, e.finished, e.collisions, e.rested, e.capped};
}

std::tuple<double, double, std::int64_t> separate(const Reals& box, const InOut<double>& position,
                                                  const Reals& inverse_mass, const Reals& radius,
                                                  const In<std::int32_t>& pairs) {
    const auto n = position.rows("position", {-1, 3});
    const auto m = pairs.rows("pairs", {-1, 2});
    double* x = position.checked("position", {n, 3});
    const double *mass = inverse_mass.checked("inverse_mass", {n}), *a = radius.checked("radius", {n});
    const std::int32_t* ids = checked_pairs(pairs, "pairs", m, n, make_box(box));
    const contacts::Box b = make_box(box);
    nb::gil_scoped_release unlocked;
    const contacts::Gaps gaps = contacts::separate(x, mass, a, b, ids, m);
    return {gaps.smallest, gaps.largest_overlap, gaps.deepest};
}

void end_step(const Reals& box, const InOut<double>& position, const InOut<double>& velocity,
              const InOut<double>& angular_velocity, const InOut<double>& orientation,
              const InOut<std::int64_t>& crossings, const InOut<double>& rotation, const Reals& force,
              const Reals& torque, const Reals& inverse_mass, const Reals& inverse_moment,
              const In<bool>& is_active, double dt) {
    const auto n = position.rows("position", {-1, 3});
    const contacts::Box b = make_box(box);
    double *x = position.checked("position", {n, 3}), *v = velocity.checked("velocity", {n, 3});
    double *w = angular_velocity.checked("angular_velocity", {n, 3}),
           *q = orientation.checked("orientation", {n, 4});
    std::int64_t* crossed = crossings.checked("crossings", {n, 3});
    double* r = rotation.checked("rotation", {n, 3});
    const double *f = force.checked("force", {n, 3}), *t = torque.checked("torque", {n, 3});
    const double *m = inverse_mass.checked("inverse_mass", {n}),
                 *i = inverse_moment.checked("inverse_moment", {n});
    const bool* moved = is_active.checked("is_active", {n});
    nb::gil_scoped_release unlocked;
    for (std::int64_t k = 0; k < n; ++k) {
        if (!moved[k])
            contacts::fly(x + 3 * k, v + 3 * k, w + 3 * k, r + 3 * k, f + 3 * k, t + 3 * k, m[k], i[k], dt);
        contacts::settle(b, x + 3 * k, q + 4 * k, crossed + 3 * k, r + 3 * k);
    }
}

void lubrication_resistance(const Reals& gap, const ConstBytes& lubrication,
                            const InOut<double>& resistance) {
    const std::int64_t n = gap.rows("gap", {-1});
    const double* g = gap.checked("gap", {n});
    double* out = resistance.checked("resistance", {n});
    const auto* row = checked_rows<contacts::LubricationRow>(lubrication, "lubrication", 1);
    for (std::int64_t k = 0; k < n; ++k) out[k] = row->resistance(g[k]);
}

}  // namespace

void bind_contacts(nb::module_& module) {
    module.def("find_pairs", &find_pairs, nb::arg("box"), nb::arg("position"), nb::arg("velocity"),
               nb::arg("force"), nb::arg("radius"), nb::arg("inverse_mass"), nb::arg("dt"), nb::arg("margin"),
               nb::arg("cell_start"), nb::arg("cell_order"), nb::arg("pairs"));
    module.def("nearest_surfaces", &nearest_surfaces, nb::arg("box"), nb::arg("position"), nb::arg("radius"),
               nb::arg("cell_start"), nb::arg("cell_order"), nb::arg("gap"), nb::arg("neighbour"));
    nb::class_<contacts::Kernel>(module, "ContactKernel",
                                 "A driver compiled for one contact law, and the rows of that law.")
        .def_static("at", &kernel_at, nb::arg("address"), nb::rv_policy::reference)
        .def_prop_ro("parameters", [](const contacts::Kernel& k) { return layout_dict(k.parameters); })
        .def_prop_ro("history", [](const contacts::Kernel& k) { return layout_dict(k.history); });
    module.def("soft_sphere_kernel", [] { return &soft_sphere; }, nb::rv_policy::reference);
    module.def("adaptive_kernel", [] { return &adaptive; }, nb::rv_policy::reference);
    module.def("hertz_kernel", [] { return &hertz; }, nb::rv_policy::reference);
    module.def("repulsive_kernel", [] { return &repulsive; }, nb::rv_policy::reference);
    module.def("contact_layouts", &contact_layouts);
    module.def("run_substeps", &run_substeps, nb::arg("kernel"), nb::arg("box"), nb::arg("position"),
               nb::arg("velocity"), nb::arg("angular_velocity"), nb::arg("rotation"),
               nb::arg("velocity_increment"), nb::arg("angular_increment"), nb::arg("inverse_mass"),
               nb::arg("inverse_moment"), nb::arg("radius"), nb::arg("impulse"), nb::arg("angular_impulse"),
               nb::arg("contact_impulse"), nb::arg("active"), nb::arg("pairs"), nb::arg("parameters"),
               nb::arg("lubrication"), nb::arg("state"), nb::arg("history"), nb::arg("finished"),
               nb::arg("time"), nb::arg("h"), nb::arg("overlap_limit"), nb::arg("first"), nb::arg("last"));
    module.def("hard_sphere_layouts", &hard_sphere_layouts);
    module.def("run_events", &run_events, nb::arg("box"), nb::arg("position"), nb::arg("velocity"),
               nb::arg("angular_velocity"), nb::arg("rotation"), nb::arg("acceleration"),
               nb::arg("angular_acceleration"), nb::arg("inverse_mass"), nb::arg("inverse_moment"),
               nb::arg("radius"), nb::arg("impulse"), nb::arg("angular_impulse"), nb::arg("contact_impulse"),
               nb::arg("active"), nb::arg("pairs"), nb::arg("parameters"), nb::arg("lubrication"),
               nb::arg("state"), nb::arg("history"), nb::arg("finished"), nb::arg("events"), nb::arg("start"),
               nb::arg("length"), nb::arg("rest_speed"), nb::arg("quiet"), nb::arg("most_events"),
               nb::arg("is_new"));
    module.def("separate", &separate, nb::arg("box"), nb::arg("position"), nb::arg("inverse_mass"),
               nb::arg("radius"), nb::arg("pairs"));
    module.def("end_step", &end_step, nb::arg("box"), nb::arg("position"), nb::arg("velocity"),
               nb::arg("angular_velocity"), nb::arg("orientation"), nb::arg("crossings"), nb::arg("rotation"),
               nb::arg("force"), nb::arg("torque"), nb::arg("inverse_mass"), nb::arg("inverse_moment"),
               nb::arg("is_active"), nb::arg("dt"));
    module.def("lubrication_resistance", &lubrication_resistance, nb::arg("gap"), nb::arg("lubrication"),
               nb::arg("resistance"));
}
