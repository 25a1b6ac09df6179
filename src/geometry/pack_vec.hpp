// SPDX-License-Identifier: MIT
// Three-component vectors of packs, for kernels written once for every vector width. The sums are those of vec3.hpp,
// lane by lane. Include after a pack header; like the packs, everything has internal linkage.
#pragma once

namespace flotilla {
namespace {

template <class P>
struct PackVec {
    P x, y, z;
};
template <class P>
inline PackVec<P> operator+(const PackVec<P>& a, const PackVec<P>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class P>
inline PackVec<P> operator-(const PackVec<P>& a, const PackVec<P>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class P>
inline PackVec<P> operator*(P s, const PackVec<P>& a) {
    return {s * a.x, s * a.y, s * a.z};
}
template <class P>
inline P dot(const PackVec<P>& a, const PackVec<P>& b) {
    return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
template <class P>
inline PackVec<P> cross(const PackVec<P>& a, const PackVec<P>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class P, class M>
inline PackVec<P> select(M m, const PackVec<P>& a, const PackVec<P>& b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

} // namespace
} // namespace flotilla
