// SPDX-License-Identifier: MIT
// Arrays over the memory of a World, without copies. What they need lives as long as they do: those of bodies hold the
// World, and pin its places (World::pin()); those of contacts hold the list that they show.
#include <cstddef>

#include "python/bind.hpp"
#include "python/world_class.hpp"

namespace flotilla::python {
namespace {

/// An array of type and shape that holds `owner`, and that nobody can write to.
template <class Owner>
py::array read_only(const py::dtype& type, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                    const void* data, Owner&& owner) {
    using Kept = std::decay_t<Owner>;
    const py::capsule base(new Kept(std::forward<Owner>(owner)), [](void* kept) { delete static_cast<Kept*>(kept); });
    py::array array(type, std::move(shape), std::move(strides), data, base);
    array.attr("flags").attr("writeable") = false;
    return array;
}

struct PinnedWorld {
    py::object world;
    std::shared_ptr<const void> pin;
};

/// (places, width), of doubles that lie `offset` bytes behind the start of each element.
template <class T>
py::array column(const py::object& self, std::span<const T> elements, std::size_t offset, py::ssize_t width) {
    const auto n = static_cast<py::ssize_t>(elements.size());
    return read_only(py::dtype::of<double>(), {n, width},
                     {static_cast<py::ssize_t>(sizeof(T)), static_cast<py::ssize_t>(sizeof(double))},
                     reinterpret_cast<const std::byte*>(elements.data()) + offset,
                     PinnedWorld{self, self.cast<PythonWorld&>().world().pin()});
}

py::array contacts_view(const PythonWorld& w) {
    std::shared_ptr<const std::vector<ContactState>> list = w.world().shared_contacts();
    const auto n = static_cast<py::ssize_t>(list->size());
    const void* const data = list->data();
    return read_only(contact_type(), {n}, {static_cast<py::ssize_t>(sizeof(ContactState))}, data, std::move(list));
}

} // namespace

py::dtype structured(const py::list& names, const py::list& formats, const py::list& offsets, std::size_t size) {
    return py::dtype(names, formats, offsets, static_cast<py::ssize_t>(size));
}

py::dtype contact_type() {
    using C = ContactState;
    py::list names, formats, offsets;
    const auto add = [&](const char* name, const char* format, std::size_t offset) {
        names.append(name), formats.append(format), offsets.append(offset);
    };
    add("body_a", "i4", offsetof(C, body_a));
    add("body_b", "i4", offsetof(C, body_b));
    add("point", "3f8", offsetof(C, point));
    add("normal", "3f8", offsetof(C, normal));
    add("distance", "f8", offsetof(C, distance));
    add("impulse", "3f8", offsetof(C, impulse));
    add("asleep", "?", offsetof(C, asleep));
    add("across", "3f8", offsetof(C, across));
    return structured(names, formats, offsets, sizeof(C));
}

void bind_views(WorldClass& type) {
    const auto of_pose = [&](const char* name, std::size_t offset, py::ssize_t width, const char* doc) {
        type.def_property_readonly(
            name,
            [=](const py::object& self) {
                return column(self, self.cast<PythonWorld&>().world().poses(), offset, width);
            },
            doc);
    };
    const auto of_motion = [&](const char* name, std::size_t offset, const char* doc) {
        type.def_property_readonly(
            name,
            [=](const py::object& self) {
                return column(self, self.cast<PythonWorld&>().world().motions(), offset, 3);
            },
            doc);
    };
    of_pose("positions_view", offsetof(Pose, origin), 3,
            "As positions, but over the World's own memory, read only: it always shows the present state, and nothing "
            "that steps between edits half-way. While such an array is in use the World lives, and what would change "
            "the number of places (add_body where no place is free, restore to another number) is refused with "
            "InputError. While a step runs on another thread, rows may be of before or after it.");
    of_pose("rotations_view", offsetof(Pose, rotation), 4,
            "As rotations, shape (places, 4), over the World's own memory; see positions_view.");
    of_pose("centers_of_mass_view", offsetof(Pose, com), 3,
            "As centers_of_mass, shape (places, 3), over the World's own memory; see positions_view.");
    of_motion("velocities_view", offsetof(Motion, velocity),
              "As velocities, shape (places, 3), over the World's own memory; see positions_view.");
    of_motion("angular_momenta_view", offsetof(Motion, momentum),
              "What the World keeps in place of angular velocities: of dynamic bodies angular momenta about their "
              "centres of mass, kg m^2/s, of others angular velocities, rad/s; world axes, shape (places, 3), over the "
              "World's own memory; see positions_view.");
    type.def_property_readonly(
        "contacts_view", &contacts_view,
        "As contacts, but the World's own list, read only, without a copy. It stays what it is: ask again after a step "
        "or an edit.");
}

} // namespace flotilla::python
