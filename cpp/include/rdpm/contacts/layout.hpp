// The layout of rows that cross the border: Python compares its structured dtypes with it, once, at import.
#pragma once
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace rdpm::contacts {

// One member of a row: doubles ('f') or 64-bit integers ('i'), `count` of them.
struct Field {
    const char* name;
    std::size_t offset, count;
    char kind;
};

template <class Member>
constexpr Field field(const char* name, std::size_t offset) {
    using Scalar = std::remove_all_extents_t<Member>;
    static_assert(std::is_same_v<Scalar, double> || std::is_same_v<Scalar, std::int64_t>);
    return {name, offset, sizeof(Member) / sizeof(Scalar), std::is_same_v<Scalar, double> ? 'f' : 'i'};
}

#define RDPM_FIELD(Row, member) rdpm::contacts::field<decltype(Row::member)>(#member, offsetof(Row, member))

// A row without members takes no space in an array of NumPy.
struct Layout {
    const Field* fields;
    std::size_t count, size;
};

template <class Row, class Fields>
constexpr Layout layout_of(const Fields& fields) {
    return {fields.data(), fields.size(), std::is_empty_v<Row> ? 0 : sizeof(Row)};
}

}  // namespace rdpm::contacts
