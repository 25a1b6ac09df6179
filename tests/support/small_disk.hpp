// SPDX-License-Identifier: MIT
#pragma once

#include <sys/mount.h>

#include <filesystem>
#include <string>

namespace flotilla::test {

/// A folder on a file system of its own; only the superuser can make one.
class SmallDisk {
  public:
    SmallDisk(const std::filesystem::path& where, const std::string& size) : where_(where) {
        std::filesystem::create_directory(where);
        mounted_ = ::mount("tmpfs", where.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
    }
    ~SmallDisk() {
        if (mounted_) ::umount(where_.c_str());
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;
    [[nodiscard]] bool mounted() const { return mounted_; }
    void make_read_only() const { ::mount("tmpfs", where_.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr); }

  private:
    std::filesystem::path where_;
    bool mounted_;
};

} // namespace flotilla::test
