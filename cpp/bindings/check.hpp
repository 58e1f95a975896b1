// The border: an array is taken as it is or refused with its name; nothing is converted or copied.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "rdpm/grid/grid.hpp"

namespace rdpm {

namespace nb = nanobind;

// The element type of an array: NumPy's name of it, and whether a format of the buffer protocol means it.
// Specialise it for a struct whose rows NumPy holds under a structured dtype.
template <class T>
struct Element {
    static_assert(std::is_arithmetic_v<T>);
    static constexpr auto name = nb::detail::dtype_traits<T>::name;
    static bool matches(const char* format) {
        constexpr bool is_little = std::endian::native == std::endian::little;
        if (*format == '@' || *format == '=' || *format == (is_little ? '<' : '>')) ++format;
        const char* codes = std::is_same_v<T, bool>       ? "?"
                            : std::is_floating_point_v<T> ? "fd"
                            : std::is_signed_v<T>         ? "bhilqn"
                                                          : "BHILQN";
        return *format != '\0' && std::strchr(codes, *format) && format[1] == '\0';
    }
};

using Shape = std::initializer_list<std::int64_t>;  // -1: any extent

inline std::string shape_text(const std::int64_t* shape, std::size_t count) {
    std::string text = "(";
    for (std::size_t a = 0; a < count; ++a)
        text += (a > 0 ? ", " : "") + (shape[a] < 0 ? std::string("*") : std::to_string(shape[a]));
    return text + (count == 1 ? ",)" : ")");
}

// An array argument of a kernel, its buffer held until the call returns. A const Scalar is read alone, and
// may be read-only.
template <class Scalar>
class ArrayArgument {
  public:
    using Value = std::remove_const_t<Scalar>;

    ArrayArgument() = default;
    ArrayArgument(const ArrayArgument&) = delete;
    ArrayArgument& operator=(const ArrayArgument&) = delete;
    ~ArrayArgument() {
        if (is_array_) PyBuffer_Release(&view_);
    }
    // Any object is taken here: only the kernel's own check knows the argument's name.
    void take(nb::handle object) noexcept {
        object_ = object;
        is_array_ = PyObject_GetBuffer(object.ptr(), &view_, PyBUF_RECORDS_RO) == 0;
        if (!is_array_) PyErr_Clear();
    }

    // Its data, where all is as it must be; throws TypeError or ValueError with the name, what is needed and
    // what came.
    Scalar* checked(const char* name, Shape shape) const {
        if (!is_array_) refuse(nb::type_error, name, shape, std::string(Py_TYPE(object_.ptr())->tp_name));
        if (!Element<Value>::matches(view_.format ? view_.format : "B") || view_.itemsize != sizeof(Value))
            refuse(nb::type_error, name, shape, "dtype " + dtype_text());
        bool good = view_.ndim == static_cast<int>(shape.size());
        for (int axis = 0; good && axis < view_.ndim; ++axis)
            good = shape.begin()[axis] < 0 || view_.shape[axis] == shape.begin()[axis];
        if (!good) refuse(nb::value_error, name, shape, "shape " + shape_text(extents(), view_.ndim));
        if (!PyBuffer_IsContiguous(&view_, 'C'))
            refuse(nb::value_error, name, shape, "another order or strides");
        if (reinterpret_cast<std::uintptr_t>(view_.buf) % alignof(Value) != 0)
            refuse(nb::value_error, name, shape, "values that are not aligned");
        if (!std::is_const_v<Scalar> && view_.readonly)
            refuse(nb::value_error, name, shape, "a read-only array");
        return static_cast<Scalar*>(view_.buf);
    }

    // How many rows it has, for the shapes of others; `shape` must begin with -1.
    std::int64_t rows(const char* name, Shape shape) const {
        checked(name, shape);
        return view_.shape[0];
    }

  private:
    using Error = nb::builtin_exception (*)(const char*);
    [[noreturn]] void refuse(Error error, const char* name, Shape shape, const std::string& got) const {
        const std::string text = std::string(name) + ": must be a C-contiguous" +
                                 (std::is_const_v<Scalar> ? " " : ", writable ") + Element<Value>::name.text +
                                 " array of shape " + shape_text(shape.begin(), shape.size()) + ", got " +
                                 got;
        throw error(text.c_str());
    }
    const std::int64_t* extents() const {
        static_assert(sizeof(Py_ssize_t) == sizeof(std::int64_t));
        return reinterpret_cast<const std::int64_t*>(view_.shape);
    }
    std::string dtype_text() const {
        if (!nb::hasattr(object_, "dtype")) return view_.format ? view_.format : "bytes";
        const nb::object dtype = object_.attr("dtype");
        return nb::str(dtype).c_str();
    }

    nb::handle object_;
    Py_buffer view_{};
    bool is_array_ = false;
};

template <class T>
using In = ArrayArgument<const T>;  // read
template <class T>
using InOut = ArrayArgument<T>;  // written, or changed

// A field with its halo.
template <class Scalar>
Scalar* field(const Grid& g, const ArrayArgument<Scalar>& values, const char* name) {
    return values.checked(name, {g.nz() + 2, g.ny() + 2, g.nx() + 2});
}

// For what is no array: throws ValueError unless the claim holds.
inline void require(bool claim, const char* message) {
    if (!claim) throw std::invalid_argument(message);
}

}  // namespace rdpm

namespace nanobind::detail {

template <class Scalar>
struct type_caster<rdpm::ArrayArgument<Scalar>> {
    NB_TYPE_CASTER(rdpm::ArrayArgument<Scalar>, const_name("numpy.ndarray[dtype=") +
                                                    rdpm::Element<std::remove_const_t<Scalar>>::name +
                                                    const_name("]"))
    bool from_python(handle source, std::uint32_t, cleanup_list*) noexcept {
        value.take(source);
        return true;
    }
};

}  // namespace nanobind::detail
