// SPDX-License-Identifier: MIT
// The library's exceptions as those of flotilla._errors, with their data.
#include <exception>

#include "python/bind.hpp"

namespace flotilla::python {
namespace {

py::object error_class(const char* name) { return py::module_::import("flotilla._errors").attr(name); }

/// Sets Python's error: an instance of the class with its message and data.
template <class... Data>
void raise(const char* name, const std::exception& error, Data&&... data) {
    const py::object type = error_class(name);
    PyErr_SetObject(type.ptr(), type(error.what(), std::forward<Data>(data)...).ptr());
}

py::tuple names_of(const BodyNames& pair) { return py::make_tuple(pair.a, pair.b, pair.name_a, pair.name_b); }

template <class Items, class Convert>
py::tuple tuple_of(const Items& items, Convert&& convert) {
    py::tuple out(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) out[i] = convert(items[i]);
    return out;
}

void translate(std::exception_ptr pointer) {
    try {
        if (pointer) std::rethrow_exception(pointer);
    } catch (const InputError& e) {
        raise("InputError", e,
              tuple_of(e.problems(), [](const InputProblem& p) { return py::make_tuple(p.where, p.reason); }));
    } catch (const IoError& e) {
        raise("IoError", e);
    } catch (const OverlapError& e) {
        raise("OverlapError", e, tuple_of(e.pairs(), [](const OverlapError::Pair& p) {
                  return py::make_tuple(p.a, p.b, p.name_a, p.name_b, p.triangle_pairs);
              }));
    } catch (const ScriptError& e) {
        raise("ScriptError", e, e.step(), tuple_of(e.pairs(), names_of));
    } catch (const StepCancelled& e) {
        raise("StepCancelled", e);
    } catch (const BrokenPromise& e) {
        raise("BrokenPromise", e, e.step(), names_of(e.pair()));
    } catch (const Error& e) {
        raise("Error", e);
    }
}

} // namespace

void bind_errors(py::module_&) { py::register_local_exception_translator(&translate); }

} // namespace flotilla::python
