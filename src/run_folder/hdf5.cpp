// SPDX-License-Identifier: MIT
#include "run_folder/hdf5.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <mutex>
#include <new>
#include <numeric>
#include <utility>

#include <hdf5.h>

#include <flotilla/error.hpp>

#include "io/file.hpp"

namespace flotilla::io {
namespace {

std::mutex& library_lock() {
    static std::mutex lock;
    return lock;
}

/// One call into the library: the lock is held and the library prints nothing.
class Call {
  public:
    Call() : guard_(library_lock()) {
        H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    ~Call() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

  private:
    std::lock_guard<std::mutex> guard_;
    H5E_auto2_t print_ = nullptr;
    void* data_ = nullptr;
};

/// An identifier that closes itself; negative: the call that made it failed.
class Id {
  public:
    Id(hid_t value, herr_t (*close)(hid_t)) : value_(value), close_(close) {}
    ~Id() {
        if (value_ >= 0) close_(value_);
    }
    Id(const Id&) = delete;
    Id& operator=(const Id&) = delete;
    [[nodiscard]] hid_t get() const { return value_; }
    [[nodiscard]] bool valid() const { return value_ >= 0; }

  private:
    hid_t value_;
    herr_t (*close_)(hid_t);
};

template <typename T>
hid_t type_of();
template <>
hid_t type_of<double>() {
    return H5T_NATIVE_DOUBLE;
}
template <>
hid_t type_of<std::int64_t>() {
    return H5T_NATIVE_INT64;
}
template <>
hid_t type_of<std::int32_t>() {
    return H5T_NATIVE_INT32;
}
template <>
hid_t type_of<std::uint64_t>() {
    return H5T_NATIVE_UINT64;
}
template <>
hid_t type_of<std::uint16_t>() {
    return H5T_NATIVE_UINT16;
}
template <>
hid_t type_of<std::uint8_t>() {
    return H5T_NATIVE_UINT8;
}

/// Strings have a fixed size, padded with zeros. Those of variable size live in a heap without checksums, and damage
/// there crashes the library.
Id string_type(std::size_t size) {
    const Id type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.get(), std::max<std::size_t>(size, 1));
    H5Tset_cset(type.get(), H5T_CSET_UTF8);
    H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
    return {H5Tcopy(type.get()), H5Tclose};
}

/// Only memory can run out here: nothing touches a disk.
void require(bool ok, const std::string& what) {
    if (!ok) throw IoError("HDF5 could not write " + what + " (out of memory?)");
}

/// The library does not survive memory that is refused: it follows pointers that it did not get (H5AC_create, 1.10.8)
/// or cannot close its files any more. So what a call may need is asked for here, all at once, and given back: refused,
/// nothing has begun. `data`: bytes, of the image and of what is added to it.
void ensure_memory(std::size_t data) {
    constexpr std::size_t kLibrary = std::size_t{4} << 20; // an open file and its caches take 1.8 MB
    constexpr std::size_t kCopies = 2;                     // a growing image is moved
    void* const memory = std::malloc(kLibrary + kCopies * data);
    if (memory == nullptr) throw std::bad_alloc();
    std::free(memory);
}

/// The library takes two open images of one name for the same file.
std::string unique_name() {
    static std::uint64_t counter = 0; // under the library's lock
    return "flotilla-image-" + std::to_string(counter++);
}

/// Images grow by this much at a time.
constexpr std::size_t kImageIncrement = 1u << 20;

Id memory_file_access() {
    Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fapl_core(access.get(), kImageIncrement, false);
    // The newest format checksums its metadata, so that damage there is seen as such.
    H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_LATEST);
    return {H5Pcopy(access.get()), H5Pclose};
}

// The trailer: the ranges that the checksum leaves out, then this.
struct TrailerEnd {
    std::uint64_t num_unchecked;
    std::uint64_t checksum; ///< of the image without those ranges, and of the ranges
    std::uint64_t magic;
};
constexpr std::uint64_t kTrailerMagic = 0x616c6c69746f6c66; // "flotilla"

std::uint64_t checksum_outside(std::span<const std::byte> image, std::span<const ByteRange> unchecked) {
    std::vector<std::uint64_t> parts{checksum(std::as_bytes(unchecked))};
    std::uint64_t begin = 0;
    for (const auto& range : unchecked) {
        parts.push_back(checksum(image.subspan(begin, range.begin - begin)));
        begin = range.begin + range.size;
    }
    parts.push_back(checksum(image.subspan(begin)));
    return checksum(std::as_bytes(std::span(parts)));
}

void append_trailer(std::vector<std::byte>& image, std::vector<ByteRange> unchecked) {
    std::sort(unchecked.begin(), unchecked.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
    const TrailerEnd end{unchecked.size(), checksum_outside(image, unchecked), kTrailerMagic};
    const auto ranges = std::as_bytes(std::span(unchecked));
    image.insert(image.end(), ranges.begin(), ranges.end());
    const auto last = std::as_bytes(std::span(&end, 1));
    image.insert(image.end(), last.begin(), last.end());
}

/// Removes the trailer from a file's bytes. False where there is none or the bytes do not match it.
bool remove_trailer(std::vector<std::byte>& file) {
    TrailerEnd end{};
    if (file.size() < sizeof end) return false;
    std::memcpy(&end, file.data() + file.size() - sizeof end, sizeof end);
    const std::size_t rest = file.size() - sizeof end;
    if (end.magic != kTrailerMagic || end.num_unchecked > rest / sizeof(ByteRange)) return false;
    std::vector<ByteRange> unchecked(end.num_unchecked);
    const std::size_t size = rest - end.num_unchecked * sizeof(ByteRange);
    if (!unchecked.empty()) std::memcpy(unchecked.data(), file.data() + size, unchecked.size() * sizeof(ByteRange));
    std::uint64_t begin = 0;
    for (const auto& range : unchecked) {
        if (range.begin < begin || range.begin > size || range.size > size - range.begin) return false;
        begin = range.begin + range.size;
    }
    file.resize(size);
    return checksum_outside(file, unchecked) == end.checksum;
}

} // namespace

// The image is what the library leaves in memory when it closes the file, kept by callbacks that own that memory.
// H5Fget_file_image is no way to it: it resets a flag in the superblock and leaves the checksum as it was (1.10.8), so
// that its images do not open.
struct Hdf5Writer::Memory {
    void* data = nullptr;
    std::size_t size = 0;
    ~Memory() { std::free(data); }

    void* keep(void* memory, std::size_t bytes) {
        if (memory != nullptr) data = memory, size = bytes;
        return memory;
    }
    static void* allocate(std::size_t size, H5FD_file_image_op_t, void* memory) {
        return static_cast<Memory*>(memory)->keep(std::malloc(size), size);
    }
    static void* reallocate(void* data, std::size_t size, H5FD_file_image_op_t, void* memory) {
        return static_cast<Memory*>(memory)->keep(std::realloc(data, size), size);
    }
    static herr_t release(void*, H5FD_file_image_op_t, void*) { return 0; }
    static void* copy_user_data(void* memory) { return memory; }
    static herr_t release_user_data(void*) { return 0; }
};

Hdf5Writer::Hdf5Writer() : memory_(std::make_unique<Memory>()) {
    ensure_memory(kImageIncrement);
    const Call call;
    const Id access = memory_file_access();
    H5FD_file_image_callbacks_t callbacks{
        Memory::allocate,          nullptr,      Memory::reallocate, Memory::release, Memory::copy_user_data,
        Memory::release_user_data, memory_.get()};
    H5Pset_file_image_callbacks(access.get(), &callbacks);
    file_ = H5Fcreate(unique_name().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get());
    require(file_ >= 0, "a file");
}

Hdf5Writer::~Hdf5Writer() {
    const Call call;
    if (file_ >= 0) H5Fclose(file_);
}

void Hdf5Writer::create_group(const std::string& name) {
    const Call call;
    const Id group(H5Gcreate2(file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    require(group.valid(), name);
}

template <typename T>
void Hdf5Writer::write(const std::string& name, std::span<const T> values, std::initializer_list<std::size_t> shape,
                       Checked checked) {
    ensure_memory(memory_->size + values.size_bytes());
    const Call call;
    const std::vector<hsize_t> dims(shape.begin(), shape.end());
    const Id space(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr), H5Sclose);
    const Id dataset(H5Dcreate2(file_, name.c_str(), type_of<T>(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose);
    require(dataset.valid(), name);
    if (values.empty()) return;
    require(H5Dwrite(dataset.get(), type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0, name);
    if (checked == Checked::by_owner) unchecked_.push_back({H5Dget_offset(dataset.get()), values.size_bytes()});
}

void Hdf5Writer::write_strings(const std::string& name, const std::vector<std::string>& values) {
    std::size_t width = 1;
    for (const auto& value : values) width = std::max(width, value.size());
    ensure_memory(memory_->size + 2 * width * values.size());
    const Call call;
    const hsize_t size = values.size();
    const Id space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    const Id type = string_type(width);
    const Id dataset(H5Dcreate2(file_, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose);
    require(dataset.valid(), name);
    if (values.empty()) return;
    std::string padded;
    for (const auto& value : values) padded.append(value).append(width - value.size(), '\0');
    require(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) >= 0, name);
}

void Hdf5Writer::attribute(const std::string& object, const std::string& name, std::int64_t value) {
    const Call call;
    const Id space(H5Screate(H5S_SCALAR), H5Sclose);
    const Id attribute(H5Acreate_by_name(file_, object.c_str(), name.c_str(), H5T_NATIVE_INT64, space.get(),
                                         H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                       H5Aclose);
    require(attribute.valid() && H5Awrite(attribute.get(), H5T_NATIVE_INT64, &value) >= 0, name);
}

void Hdf5Writer::attribute(const std::string& object, const std::string& name, const std::string& value) {
    const Call call;
    const Id space(H5Screate(H5S_SCALAR), H5Sclose);
    const Id type = string_type(value.size());
    const Id attribute(H5Acreate_by_name(file_, object.c_str(), name.c_str(), type.get(), space.get(), H5P_DEFAULT,
                                         H5P_DEFAULT, H5P_DEFAULT),
                       H5Aclose);
    require(attribute.valid() && H5Awrite(attribute.get(), type.get(), value.c_str()) >= 0, name);
}

std::vector<std::byte> Hdf5Writer::finish() {
    ensure_memory(memory_->size);
    const Call call;
    require(H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0, "a file");
    const ssize_t size = H5Fget_file_image(file_, nullptr, 0);
    require(size >= 0 && H5Fclose(std::exchange(file_, -1)) >= 0, "a file");
    const auto* bytes = static_cast<const std::byte*>(memory_->data);
    std::vector<std::byte> image(bytes, bytes + size);
    append_trailer(image, std::move(unchecked_));
    return image;
}

Hdf5Reader::Hdf5Reader(const std::filesystem::path& path) : path_(path), file_(-1) {
    auto image = read_file(path);
    ensure_memory(image.size());
    const Call call;
    const Id access = memory_file_access();
    if (!remove_trailer(image)) throw IoError(path_.string() + ": truncated or damaged, or not written by flotilla");
    H5Pset_file_image(access.get(), image.data(), image.size());
    file_ = H5Fopen(unique_name().c_str(), H5F_ACC_RDONLY, access.get());
    if (file_ < 0) throw IoError(path_.string() + ": HDF5 cannot open it");
}

Hdf5Reader::~Hdf5Reader() {
    const Call call;
    if (file_ >= 0) H5Fclose(file_);
}

namespace {

[[noreturn]] void fail_read(const Hdf5Reader& reader, const std::string& name) {
    throw IoError(reader.path().string() + ": damaged: cannot read '" + name + "'");
}

/// 0 where the type is not a string of fixed size.
std::size_t fixed_string_size(hid_t type) {
    return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 ? H5Tget_size(type) : 0;
}

std::string unpadded(const std::string& text) { return text.substr(0, text.find('\0')); }

std::vector<hsize_t> dimensions(hid_t space) {
    const int rank = H5Sget_simple_extent_ndims(space);
    std::vector<hsize_t> dims(static_cast<std::size_t>(std::max(rank, 0)));
    H5Sget_simple_extent_dims(space, dims.data(), nullptr);
    return dims;
}

} // namespace

bool Hdf5Reader::has(const std::string& name) const {
    const Call call;
    return H5Lexists(file_, name.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::size_t> Hdf5Reader::shape(const std::string& name) const {
    const Call call;
    const Id dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.valid()) fail_read(*this, name);
    const Id space(H5Dget_space(dataset.get()), H5Sclose);
    const auto dims = dimensions(space.get());
    return {dims.begin(), dims.end()};
}

template <typename T>
std::vector<T> Hdf5Reader::read(const std::string& name) const {
    const auto dims = shape(name);
    std::size_t size = 1;
    // A damaged shape must not ask for more memory than any file holds.
    for (const std::size_t n : dims) {
        if (n != 0 && size > (std::size_t{1} << 40) / n) fail_read(*this, name);
        size *= n;
    }
    const Call call;
    const Id dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.valid() || H5Dget_storage_size(dataset.get()) < size) fail_read(*this, name);
    std::vector<T> values(size);
    if (size != 0 && H5Dread(dataset.get(), type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
        fail_read(*this, name);
    return values;
}

template <typename T>
void Hdf5Reader::read_row(const std::string& name, std::size_t row, std::span<T> values) const {
    const Call call;
    const Id dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.valid()) fail_read(*this, name);
    const Id file_space(H5Dget_space(dataset.get()), H5Sclose);
    auto count = dimensions(file_space.get());
    if (count.empty() || row >= count[0]) fail_read(*this, name);
    std::vector<hsize_t> start(count.size(), 0);
    start[0] = row;
    count[0] = 1;
    if (std::accumulate(count.begin(), count.end(), hsize_t{1}, std::multiplies<>()) != values.size())
        fail_read(*this, name);
    if (values.empty()) return;
    H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
    const hsize_t size = values.size();
    const Id memory_space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    if (H5Dread(dataset.get(), type_of<T>(), memory_space.get(), file_space.get(), H5P_DEFAULT, values.data()) < 0)
        fail_read(*this, name);
}

std::vector<std::string> Hdf5Reader::read_strings(const std::string& name) const {
    const Call call;
    const Id dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.valid()) fail_read(*this, name);
    const Id space(H5Dget_space(dataset.get()), H5Sclose);
    const Id type(H5Dget_type(dataset.get()), H5Tclose);
    const auto dims = dimensions(space.get());
    const std::size_t width = fixed_string_size(type.get());
    if (dims.size() != 1 || width == 0 || H5Dget_storage_size(dataset.get()) / width < dims[0]) fail_read(*this, name);
    std::string padded(dims[0] * width, '\0');
    if (!padded.empty() && H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0)
        fail_read(*this, name);
    std::vector<std::string> values;
    for (std::size_t i = 0; i < dims[0]; ++i) values.push_back(unpadded(padded.substr(i * width, width)));
    return values;
}

std::int64_t Hdf5Reader::int_attribute(const std::string& object, const std::string& name) const {
    const Call call;
    const Id attribute(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    std::int64_t value = 0;
    if (!attribute.valid() || H5Aread(attribute.get(), H5T_NATIVE_INT64, &value) < 0) fail_read(*this, name);
    return value;
}

std::string Hdf5Reader::string_attribute(const std::string& object, const std::string& name) const {
    const Call call;
    const Id attribute(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (!attribute.valid()) fail_read(*this, name);
    const Id type(H5Aget_type(attribute.get()), H5Tclose);
    std::string padded(fixed_string_size(type.get()), '\0');
    if (padded.empty() || H5Aread(attribute.get(), type.get(), padded.data()) < 0) fail_read(*this, name);
    return unpadded(padded);
}

#define FLOTILLA_HDF5_ELEMENT(T)                                                                                       \
    template void Hdf5Writer::write<T>(const std::string&, std::span<const T>, std::initializer_list<std::size_t>,     \
                                       Checked);                                                                       \
    template std::vector<T> Hdf5Reader::read<T>(const std::string&) const;                                             \
    template void Hdf5Reader::read_row<T>(const std::string&, std::size_t, std::span<T>) const;
FLOTILLA_HDF5_ELEMENT(double)
FLOTILLA_HDF5_ELEMENT(std::int64_t)
FLOTILLA_HDF5_ELEMENT(std::int32_t)
FLOTILLA_HDF5_ELEMENT(std::uint64_t)
FLOTILLA_HDF5_ELEMENT(std::uint16_t)
FLOTILLA_HDF5_ELEMENT(std::uint8_t)
#undef FLOTILLA_HDF5_ELEMENT

} // namespace flotilla::io
