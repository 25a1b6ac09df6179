// SPDX-License-Identifier: MIT
// Vectors, quaternions and matrices of the interface as numpy arrays, and vectors of them without a copy.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <flotilla/types.hpp>

namespace flotilla::python {

namespace py = pybind11;

/// What holds nothing but doubles.
template <class T>
concept DoubleTuple = sizeof(T) % sizeof(double) == 0 && std::is_trivially_copyable_v<T>;
template <DoubleTuple T>
inline constexpr std::size_t kDoubles = sizeof(T) / sizeof(double);

/// An array of shape (kDoubles<T>), from anything that numpy makes one of; false where it is none. Throws TypeError
/// where it has another length, which "incompatible function arguments" would not tell.
template <DoubleTuple T>
bool load_doubles(py::handle source, T& value) {
    if (py::isinstance<py::str>(source)) return false;
    const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(source);
    if (!array) {
        PyErr_Clear();
        return false;
    }
    if (array.ndim() != 1) return false;
    if (static_cast<std::size_t>(array.size()) != kDoubles<T>)
        throw py::type_error("a vector of " + std::to_string(array.size()) + " numbers, where " +
                             std::to_string(kDoubles<T>) + " are due");
    std::memcpy(static_cast<void*>(&value), array.data(), sizeof(T));
    return true;
}

template <DoubleTuple T>
py::array_t<double> to_array(const T& value) {
    py::array_t<double> array(static_cast<py::ssize_t>(kDoubles<T>));
    std::memcpy(array.mutable_data(), &value, sizeof(T));
    return array;
}

/// An array over the elements of `values`, which it owns from now on.
template <class T>
py::array owning_array(std::vector<T>&& values, const py::dtype& type, std::vector<py::ssize_t> shape) {
    auto* const kept = new std::vector<T>(std::move(values));
    const py::capsule owner(kept, [](void* data) { delete static_cast<std::vector<T>*>(data); });
    return py::array(type, std::move(shape), {}, kept->data(), owner);
}

/// (n), of plain numbers.
template <class T>
py::array numbers(std::vector<T>&& values) {
    const auto n = static_cast<py::ssize_t>(values.size());
    return owning_array(std::move(values), py::dtype::of<T>(), {n});
}

/// (outer..., kDoubles<T>).
template <DoubleTuple T>
py::array rows(std::vector<T>&& values, std::vector<py::ssize_t> outer) {
    outer.push_back(static_cast<py::ssize_t>(kDoubles<T>));
    return owning_array(std::move(values), py::dtype::of<double>(), std::move(outer));
}
template <DoubleTuple T>
py::array rows(std::vector<T>&& values) {
    const auto n = static_cast<py::ssize_t>(values.size());
    return rows(std::move(values), {n});
}

} // namespace flotilla::python

namespace pybind11::detail {

template <class T>
struct doubles_caster {
    static handle cast(const T& value, return_value_policy, handle) {
        return flotilla::python::to_array(value).release();
    }
};
template <>
struct type_caster<flotilla::Vec3> : doubles_caster<flotilla::Vec3> {
    PYBIND11_TYPE_CASTER(flotilla::Vec3, const_name("numpy.ndarray"));
    bool load(handle source, bool) { return flotilla::python::load_doubles(source, value); }
    using doubles_caster::cast;
};
template <>
struct type_caster<flotilla::Quat> : doubles_caster<flotilla::Quat> {
    PYBIND11_TYPE_CASTER(flotilla::Quat, const_name("numpy.ndarray"));
    bool load(handle source, bool) { return flotilla::python::load_doubles(source, value); }
    using doubles_caster::cast;
};

} // namespace pybind11::detail
