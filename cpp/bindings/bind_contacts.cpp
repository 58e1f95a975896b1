// Contacts: neighbours, sub-steps, the end of a step. Python owns every array; rooms of scratch come from
// there too.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <string>
#include <tuple>
#include <type_traits>

#include "check.hpp"
#include "rdpm/contacts/motion.hpp"
#include "rdpm/contacts/neighbours.hpp"
#include "rdpm/contacts/soft_sphere.hpp"
#include "rdpm/contacts/substeps.hpp"

namespace nb = nanobind;
using rdpm::Array;
using rdpm::checked;
namespace contacts = rdpm::contacts;

namespace {

using Reals = Array<const double>;
using Ints = Array<std::int32_t>;

// box: rows size, period (0: not periodic); then six rows of wall velocities.
contacts::Box make_box(const Reals& array) {
    const double* b = checked(array, "box", {8, 3});
    contacts::Box box{};
    for (int d = 0; d < 3; ++d) {
        box.size[d] = b[d];
        box.period[d] = b[3 + d];
        box.inverse_period[d] = b[3 + d] > 0 ? 1 / b[3 + d] : 0;
    }
    box.wall_velocity = b + 6;
    return box;
}

std::int64_t rows(const Reals& array) {
    return array.ndim() > 0 ? static_cast<std::int64_t>(array.shape(0)) : 0;
}

std::int64_t find_pairs(const Reals& box, const Reals& position, const Reals& velocity, const Reals& force,
                        const Reals& radius, const Reals& inverse_mass, double dt, double margin,
                        const Ints& cell_start, const Ints& cell_order, const Ints& pairs) {
    const std::int64_t n = rows(position);
    const contacts::Box b = make_box(box);
    const double *x = checked(position, "position", {n, 3}), *v = checked(velocity, "velocity", {n, 3});
    const double *f = checked(force, "force", {n, 3}), *a = checked(radius, "radius", {n});
    const double* m = checked(inverse_mass, "inverse_mass", {n});
    std::int32_t* start = checked(cell_start, "cell_start", {contacts::CellList::most_cells(n) + 1});
    std::int32_t* order = checked(cell_order, "cell_order", {n});
    std::int32_t* out = checked(pairs, "pairs", {-1, 2});
    const auto capacity = static_cast<std::int64_t>(pairs.shape(0));
    nb::gil_scoped_release unlocked;
    const double range = margin + contacts::travel(v, f, m, n, dt);
    return contacts::find_pairs(b, x, a, m, n, range, start, order, out, capacity);
}

void nearest_surfaces(const Reals& box, const Reals& position, const Reals& radius, const Ints& cell_start,
                      const Ints& cell_order, const Array<double>& gap,
                      const Array<std::int64_t>& neighbour) {
    const std::int64_t n = rows(position);
    const contacts::Box b = make_box(box);
    const double *x = checked(position, "position", {n, 3}), *a = checked(radius, "radius", {n});
    std::int32_t* start = checked(cell_start, "cell_start", {contacts::CellList::most_cells(n) + 1});
    std::int32_t* order = checked(cell_order, "cell_order", {n});
    double* g = checked(gap, "gap", {n});
    std::int64_t* j = checked(neighbour, "neighbour", {n});
    nb::gil_scoped_release unlocked;
    contacts::nearest_surfaces(b, x, a, n, start, order, g, j);
}

// Rows that cross the border are bytes here; Python compared their dtypes with these structs at import.
using Bytes = Array<std::uint8_t>;
using ConstBytes = Array<const std::uint8_t>;

template <class Row, class Array>
auto* checked_rows(const Array& array, const char* name, std::int64_t n) {
    using Pointer = std::conditional_t<std::is_same_v<Array, Bytes>, Row*, const Row*>;
    return reinterpret_cast<Pointer>(checked(array, name, {n, static_cast<std::int64_t>(sizeof(Row))}));
}

nb::dict layout_dict(const contacts::Layout& layout) {
    nb::list fields;
    for (std::size_t k = 0; k < layout.count; ++k) {
        const contacts::Field& f = layout.fields[k];
        fields.append(nb::make_tuple(f.name, f.offset, f.count, std::string(1, f.kind)));
    }
    nb::dict result;
    result["fields"] = fields;
    result["size"] = layout.size;
    return result;
}

nb::dict contact_layouts() {
    nb::dict result;
    result["state"] = layout_dict(contacts::layout_of<contacts::ContactState>(contacts::state_fields));
    result["finished"] = layout_dict(contacts::layout_of<contacts::Finished>(contacts::finished_fields));
    result["lubrication"] =
        layout_dict(contacts::layout_of<contacts::LubricationRow>(contacts::lubrication_fields));
    return result;
}

constexpr contacts::Kernel soft_sphere = contacts::kernel_of<contacts::SoftSphere>();

const contacts::Kernel& kernel_at(std::uintptr_t address) {
    const auto& kernel = *reinterpret_cast<const contacts::Kernel*>(address);
    if (kernel.task_size != sizeof(contacts::SubstepTask))
        throw std::invalid_argument("contact kernel: was compiled against other headers");
    return kernel;
}

std::tuple<std::int64_t, std::int64_t, std::int64_t, double, double> run_substeps(
    const contacts::Kernel& kernel, const Reals& box, const Array<double>& position,
    const Array<double>& velocity, const Array<double>& angular_velocity, const Array<double>& rotation,
    const Reals& velocity_increment, const Reals& angular_increment, const Reals& inverse_mass,
    const Reals& inverse_moment, const Reals& radius, const Array<double>& impulse,
    const Array<double>& angular_impulse, const Array<double>& contact_impulse,
    const Array<const std::int32_t>& active, const Array<const std::int32_t>& pairs,
    const ConstBytes& parameters, const ConstBytes& lubrication, const Bytes& state, const Bytes& history,
    const Bytes& finished, double time, double h, double overlap_limit, std::int64_t first,
    std::int64_t last) {
    const auto n = static_cast<std::int64_t>(position.ndim() > 0 ? position.shape(0) : 0);
    const auto m = static_cast<std::int64_t>(pairs.ndim() > 0 ? pairs.shape(0) : 0);
    const contacts::BodyArrays bodies{checked(position, "position", {n, 3}),
                                      checked(velocity, "velocity", {n, 3}),
                                      checked(angular_velocity, "angular_velocity", {n, 3}),
                                      checked(rotation, "rotation", {n, 3}),
                                      checked(velocity_increment, "velocity_increment", {n, 3}),
                                      checked(angular_increment, "angular_increment", {n, 3}),
                                      checked(inverse_mass, "inverse_mass", {n}),
                                      checked(inverse_moment, "inverse_moment", {n}),
                                      checked(radius, "radius", {n}),
                                      checked(impulse, "impulse", {n, 3}),
                                      checked(angular_impulse, "angular_impulse", {n, 3}),
                                      checked(contact_impulse, "contact_impulse", {n, 3})};
    const bool is_wet = lubrication.ndim() > 0 && lubrication.shape(0) > 0;
    const contacts::PairArrays rows_of_pairs{
        checked(pairs, "pairs", {m, 2}),
        checked(parameters, "parameters", {m, static_cast<std::int64_t>(kernel.parameters.size)}),
        is_wet ? checked_rows<contacts::LubricationRow>(lubrication, "lubrication", m) : nullptr,
        checked_rows<contacts::ContactState>(state, "state", m),
        checked(history, "history", {m, static_cast<std::int64_t>(kernel.history.size)}),
        m};
    const contacts::SubstepTask task{bodies,
                                     make_box(box),
                                     checked(active, "active", {-1}),
                                     static_cast<std::int64_t>(active.shape(0)),
                                     rows_of_pairs,
                                     checked_rows<contacts::Finished>(finished, "finished", -1),
                                     static_cast<std::int64_t>(finished.shape(0)),
                                     time,
                                     h,
                                     overlap_limit,
                                     first,
                                     last};
    nb::gil_scoped_release unlocked;
    const contacts::Progress p = kernel.run(task);
    return {p.next, p.finished, p.failed, p.min_gap, p.max_overlap};
}

void end_step(const Reals& box, const Array<double>& position, const Array<double>& velocity,
              const Array<double>& angular_velocity, const Array<double>& orientation,
              const Array<std::int64_t>& crossings, const Array<double>& rotation, const Reals& force,
              const Reals& torque, const Reals& inverse_mass, const Reals& inverse_moment,
              const Array<const bool>& is_active, double dt) {
    const auto n = static_cast<std::int64_t>(position.ndim() > 0 ? position.shape(0) : 0);
    const contacts::Box b = make_box(box);
    double *x = checked(position, "position", {n, 3}), *v = checked(velocity, "velocity", {n, 3});
    double *w = checked(angular_velocity, "angular_velocity", {n, 3}),
           *q = checked(orientation, "orientation", {n, 4});
    std::int64_t* crossed = checked(crossings, "crossings", {n, 3});
    double* r = checked(rotation, "rotation", {n, 3});
    const double *f = checked(force, "force", {n, 3}), *t = checked(torque, "torque", {n, 3});
    const double *m = checked(inverse_mass, "inverse_mass", {n}),
                 *i = checked(inverse_moment, "inverse_moment", {n});
    const bool* moved = checked(is_active, "is_active", {n});
    nb::gil_scoped_release unlocked;
    for (std::int64_t k = 0; k < n; ++k) {
        if (!moved[k])
            contacts::fly(x + 3 * k, v + 3 * k, w + 3 * k, r + 3 * k, f + 3 * k, t + 3 * k, m[k], i[k], dt);
        contacts::settle(b, x + 3 * k, q + 4 * k, crossed + 3 * k, r + 3 * k);
    }
}

void lubrication_resistance(const Reals& gap, const ConstBytes& lubrication,
                            const Array<double>& resistance) {
    const std::int64_t n = rows(gap);
    const double* g = checked(gap, "gap", {n});
    double* out = checked(resistance, "resistance", {n});
    const auto* row = checked_rows<contacts::LubricationRow>(lubrication, "lubrication", 1);
    for (std::int64_t k = 0; k < n; ++k) out[k] = row->resistance(g[k]);
}

}  // namespace

// What is written to must be the caller's own array, never a converted copy: noconvert.
void bind_contacts(nb::module_& module) {
    module.def("find_pairs", &find_pairs, nb::arg("box"), nb::arg("position"), nb::arg("velocity"),
               nb::arg("force"), nb::arg("radius"), nb::arg("inverse_mass"), nb::arg("dt"), nb::arg("margin"),
               nb::arg("cell_start").noconvert(), nb::arg("cell_order").noconvert(),
               nb::arg("pairs").noconvert());
    module.def("nearest_surfaces", &nearest_surfaces, nb::arg("box"), nb::arg("position"), nb::arg("radius"),
               nb::arg("cell_start").noconvert(), nb::arg("cell_order").noconvert(),
               nb::arg("gap").noconvert(), nb::arg("neighbour").noconvert());
    nb::class_<contacts::Kernel>(module, "ContactKernel",
                                 "A driver compiled for one contact law, and the rows of that law.")
        .def_static("at", &kernel_at, nb::arg("address"), nb::rv_policy::reference)
        .def_prop_ro("parameters", [](const contacts::Kernel& k) { return layout_dict(k.parameters); })
        .def_prop_ro("history", [](const contacts::Kernel& k) { return layout_dict(k.history); });
    module.def("soft_sphere_kernel", [] { return &soft_sphere; }, nb::rv_policy::reference);
    module.def("contact_layouts", &contact_layouts);
    module.def(
        "run_substeps", &run_substeps, nb::arg("kernel"), nb::arg("box"), nb::arg("position").noconvert(),
        nb::arg("velocity").noconvert(), nb::arg("angular_velocity").noconvert(),
        nb::arg("rotation").noconvert(), nb::arg("velocity_increment"), nb::arg("angular_increment"),
        nb::arg("inverse_mass"), nb::arg("inverse_moment"), nb::arg("radius"), nb::arg("impulse").noconvert(),
        nb::arg("angular_impulse").noconvert(), nb::arg("contact_impulse").noconvert(), nb::arg("active"),
        nb::arg("pairs"), nb::arg("parameters").noconvert(), nb::arg("lubrication").noconvert(),
        nb::arg("state").noconvert(), nb::arg("history").noconvert(), nb::arg("finished").noconvert(),
        nb::arg("time"), nb::arg("h"), nb::arg("overlap_limit"), nb::arg("first"), nb::arg("last"));
    module.def("end_step", &end_step, nb::arg("box"), nb::arg("position").noconvert(),
               nb::arg("velocity").noconvert(), nb::arg("angular_velocity").noconvert(),
               nb::arg("orientation").noconvert(), nb::arg("crossings").noconvert(),
               nb::arg("rotation").noconvert(), nb::arg("force"), nb::arg("torque"), nb::arg("inverse_mass"),
               nb::arg("inverse_moment"), nb::arg("is_active"), nb::arg("dt"));
    module.def("lubrication_resistance", &lubrication_resistance, nb::arg("gap"),
               nb::arg("lubrication").noconvert(), nb::arg("resistance").noconvert());
}
