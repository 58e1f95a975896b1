// The border: what Python hands over is checked here, once a call, and the message names the array.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>

namespace rdpm {

namespace nb = nanobind;

template <class Scalar>
using Array = nb::ndarray<Scalar, nb::c_contig, nb::device::cpu>;

inline std::string shape_text(std::initializer_list<std::int64_t> shape) {
    std::string text = "(";
    for (auto n : shape) text += (n < 0 ? std::string("*") : std::to_string(n)) + ", ";
    return text.substr(0, text.size() - 2) + ")";
}

// Pointer to the array's data; throws ValueError with the array's name unless its shape is the one asked (-1:
// any).
template <class Scalar>
Scalar* checked(const Array<Scalar>& array, const char* name, std::initializer_list<std::int64_t> shape) {
    bool good = array.ndim() == shape.size();
    std::size_t axis = 0;
    for (auto n : shape) {
        if (good && n >= 0 && array.shape(axis) != static_cast<std::size_t>(n)) good = false;
        ++axis;
    }
    if (!good) {
        std::string got = "(";
        for (std::size_t a = 0; a < array.ndim(); ++a) got += std::to_string(array.shape(a)) + ", ";
        throw std::invalid_argument(std::string(name) + ": shape must be " + shape_text(shape) + ", got " +
                                    got.substr(0, got.size() > 2 ? got.size() - 2 : 1) + ")");
    }
    return array.data();
}

}  // namespace rdpm
