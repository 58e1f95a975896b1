// Contacts: kernels of the laws, hard spheres, lubrication. Python owns every array; rooms of scratch come
// from there too.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "contact_arguments.hpp"
#include "rdpm/contacts/adaptive.hpp"
#include "rdpm/contacts/events.hpp"
#include "rdpm/contacts/extended.hpp"
#include "rdpm/contacts/hertz.hpp"
#include "rdpm/contacts/repulsive.hpp"
#include "rdpm/contacts/separate.hpp"
#include "rdpm/contacts/soft_sphere.hpp"
#include "rdpm/contacts/substeps.hpp"

namespace nb = nanobind;
using rdpm::Bytes;
using rdpm::checked_bodies;
using rdpm::checked_bytes;
using rdpm::checked_pairs;
using rdpm::checked_rows;
using rdpm::ConstBytes;
using rdpm::In;
using rdpm::InOut;
using rdpm::make_box;
using rdpm::Reals;
namespace contacts = rdpm::contacts;

namespace {

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
using ResistingSoft = contacts::Resisting<contacts::SoftSphere>;
using ResistingHertz = contacts::Resisting<contacts::Hertz>;
constexpr contacts::Kernel resisting_soft = contacts::kernel_of<ResistingSoft>();
constexpr contacts::Kernel resisting_hertz = contacts::kernel_of<ResistingHertz>();
constexpr contacts::Kernel cohesive_soft = contacts::kernel_of<contacts::Cohesive<ResistingSoft>>();
constexpr contacts::Kernel cohesive_hertz = contacts::kernel_of<contacts::Cohesive<ResistingHertz>>();

const contacts::Kernel& extended_kernel(bool is_hertz, bool is_cohesive) {
    if (is_hertz) return is_cohesive ? cohesive_hertz : resisting_hertz;
    return is_cohesive ? cohesive_soft : resisting_soft;
}

const contacts::Kernel& kernel_at(std::uintptr_t address) {
    const auto& kernel = *reinterpret_cast<const contacts::Kernel*>(address);
    if (kernel.task_size != sizeof(contacts::SubstepTask))
        throw std::invalid_argument("contact kernel: was compiled against other headers");
    return kernel;
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
    const InOut<double>& contact_impulse, const InOut<double>& lubrication_angular_impulse,
    const In<std::int32_t>& active, const In<std::int32_t>& pairs, const ConstBytes& parameters,
    const ConstBytes& lubrication, const Bytes& state, const Bytes& history, const Bytes& finished,
    const InOut<std::int64_t>& events, double start, double length, double rest_speed, double quiet,
    std::int64_t most_events, bool is_new) {
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
    double* turned = lubrication_angular_impulse.checked("lubrication_angular_impulse", {n, 3});
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
                                   turned,
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

// Of approach, slip and roll.
void lubrication_resistance(const Reals& gap, const ConstBytes& lubrication,
                            const InOut<double>& resistance) {
    const std::int64_t n = gap.rows("gap", {-1});
    const double* g = gap.checked("gap", {n});
    double* out = resistance.checked("resistance", {n, 3});
    const auto* row = checked_rows<contacts::LubricationRow>(lubrication, "lubrication", 1);
    for (std::int64_t k = 0; k < n; ++k) {
        out[3 * k] = row->resistance(g[k]);
        out[3 * k + 1] = row->to_slip(g[k]);
        out[3 * k + 2] = row->to_roll(g[k]);
    }
}

}  // namespace

void bind_contacts(nb::module_& module) {
    nb::class_<contacts::Kernel>(module, "ContactKernel",
                                 "A driver compiled for one contact law, and the rows of that law.")
        .def_static("at", &kernel_at, nb::arg("address"), nb::rv_policy::reference)
        .def_prop_ro("parameters", [](const contacts::Kernel& k) { return layout_dict(k.parameters); })
        .def_prop_ro("history", [](const contacts::Kernel& k) { return layout_dict(k.history); });
    module.def("soft_sphere_kernel", [] { return &soft_sphere; }, nb::rv_policy::reference);
    module.def("adaptive_kernel", [] { return &adaptive; }, nb::rv_policy::reference);
    module.def("hertz_kernel", [] { return &hertz; }, nb::rv_policy::reference);
    module.def("repulsive_kernel", [] { return &repulsive; }, nb::rv_policy::reference);
    module.def("extended_kernel", &extended_kernel, nb::rv_policy::reference, nb::arg("is_hertz"),
               nb::arg("is_cohesive"));
    module.def("contact_layouts", &contact_layouts);
    module.def("hard_sphere_layouts", &hard_sphere_layouts);
    module.def("run_events", &run_events, nb::arg("box"), nb::arg("position"), nb::arg("velocity"),
               nb::arg("angular_velocity"), nb::arg("rotation"), nb::arg("acceleration"),
               nb::arg("angular_acceleration"), nb::arg("inverse_mass"), nb::arg("inverse_moment"),
               nb::arg("radius"), nb::arg("impulse"), nb::arg("angular_impulse"), nb::arg("contact_impulse"),
               nb::arg("lubrication_angular_impulse"), nb::arg("active"), nb::arg("pairs"),
               nb::arg("parameters"), nb::arg("lubrication"), nb::arg("state"), nb::arg("history"),
               nb::arg("finished"), nb::arg("events"), nb::arg("start"), nb::arg("length"),
               nb::arg("rest_speed"), nb::arg("quiet"), nb::arg("most_events"), nb::arg("is_new"));
    module.def("separate", &separate, nb::arg("box"), nb::arg("position"), nb::arg("inverse_mass"),
               nb::arg("radius"), nb::arg("pairs"));
    module.def("lubrication_resistance", &lubrication_resistance, nb::arg("gap"), nb::arg("lubrication"),
               nb::arg("resistance"));
}
