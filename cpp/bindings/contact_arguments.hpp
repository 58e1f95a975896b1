// Arguments that the kernels of contacts share: the box, rows as bytes, ids.
#pragma once
#include <string>

#include "check.hpp"
#include "rdpm/contacts/pair.hpp"

namespace rdpm {

using Reals = In<double>;

// box: rows size, period (0: not periodic, below 0: open); six rows of wall velocities; five rows a wall
// within the box.
inline contacts::Box make_box(const Reals& array) {
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

// Rows that cross the border are bytes here; Python compared their dtypes with these structs at import.
using Bytes = InOut<std::uint8_t>;
using ConstBytes = In<std::uint8_t>;

// A struct's members are read where they lie, so the bytes begin as its values must.
template <class Byte>
Byte* checked_bytes(const ArrayArgument<Byte>& array, const char* name, std::int64_t n, std::size_t size) {
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

// Ids of bodies.
inline const std::int32_t* checked_bodies(const In<std::int32_t>& array, const char* name, std::int64_t count,
                                          std::int64_t bodies) {
    const std::int32_t* id = array.checked(name, {-1});
    for (std::int64_t k = 0; k < count; ++k)
        if (id[k] < 0 || id[k] >= bodies)
            throw std::invalid_argument(std::string(name) + ": id " + std::to_string(id[k]) + " is no body");
    return id;
}

// Ids of pairs; the second may be a wall of the box.
inline const std::int32_t* checked_pairs(const In<std::int32_t>& array, const char* name, std::int64_t count,
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

}  // namespace rdpm
