// SPDX-License-Identifier: MIT
// Who does what, among processes that share nothing but a file system.
#pragma once

#include <filesystem>
#include <optional>

namespace flotilla::mpi {

/// A file that is locked by this process and by those that it starts: the system gives the lock up when the last of
/// them has ended, however that ends. So a claim outlives a rank that is killed by just as long as the run that it
/// started needs for its checkpoint.
class Claim {
  public:
    /// Nothing where somebody else has it. IoError where the file cannot be made or the file system has no locks.
    [[nodiscard]] static std::optional<Claim> take(const std::filesystem::path& file);
    /// Waits for it.
    [[nodiscard]] static Claim wait_for(const std::filesystem::path& file);

    Claim(Claim&& other) noexcept : descriptor_(other.descriptor_) { other.descriptor_ = -1; }
    ~Claim();
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;
    Claim& operator=(Claim&&) = delete;

  private:
    explicit Claim(int descriptor) : descriptor_(descriptor) {}

    int descriptor_;
};

} // namespace flotilla::mpi
