// Arguments that the kernels of contacts share: the box, rows as bytes, ids.
#pragma once
#include <string>

#include "check.hpp"
#include "rdpm/contacts/pair.hpp"

namespace rdpm {

using Reals = In<double>;

// box: rows size, period (0: not periodic); then six rows of wall velocities.
inline contacts::Box make_box(const Reals& array) {
    const double* b = array.checked("box", {8, 3});
    contacts::Box box{};
    for (int d = 0; d < 3; ++d) {
        box.size[d] = b[d];
        box.period[d] = b[3 + d];
        box.inverse_period[d] = b[3 + d] > 0 ? 1 / b[3 + d] : 0;
    }
    box.wall_velocity = b + 6;
    return box;
}

// Rows that cross the border are bytes here; Python compared their dtypes with these structs at import.
using Bytes = InOut<std::uint8_t>;
using ConstBytes = In<std::uint8_t>;

// A struct's members are read where they lie, so the bytes begin as its values must.
template <class Byte>
Byte* checked_bytes(const ArrayArgument<Byte>& array, const char* name, std::int64_t n,
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

// Ids of bodies; of a pair's second, -1 to -6 for a face.
inline const std::int32_t* checked_ids(const In<std::int32_t>& array, const char* name, rdpm::Shape shape,
                                std::int64_t count, std::int64_t bodies, bool is_pair) {
    const std::int32_t* id = array.checked(name, shape);
    for (std::int64_t k = 0; k < count; ++k)
        if (id[k] >= bodies || id[k] < (is_pair && k % 2 == 1 ? -6 : 0))
            throw std::invalid_argument(std::string(name) + ": id " + std::to_string(id[k]) +
                                        " is no body and no face");
    return id;
}

}  // namespace rdpm
