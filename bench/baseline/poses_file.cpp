// SPDX-License-Identifier: MIT
#include "poses_file.hpp"

#include <utility>

#include <flotilla/error.hpp>

namespace flotilla::baseline {
namespace {

std::string quoted(const std::string& field) {
    std::string text = "\"";
    for (const char c : field) text.append(c == '"' ? 2 : 1, c);
    return text + '"';
}

} // namespace

PosesFile::PosesFile(const std::filesystem::path& path, const SceneDescription& scene)
    : path_(path), file_(std::fopen(path.c_str(), "w")) {
    if (file_ == nullptr) throw IoError(path.string() + ": cannot write");
    for (const BodyDescription& body : scene.bodies) names_.push_back(quoted(body.name));
    std::fputs("frame,time,body,name,px,py,pz,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n", file_);
}

PosesFile::~PosesFile() {
    if (file_ != nullptr) std::fclose(file_);
}

void PosesFile::write(std::int64_t frame, double time, const std::vector<PoseRow>& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const PoseRow& row = rows[i];
        const Vec3 &p = row.position, &v = row.velocity, &w = row.angular_velocity;
        const Quat& q = row.rotation;
        std::fprintf(file_, "%lld,%.17g,%zu,%s", static_cast<long long>(frame), time, i, names_[i].c_str());
        for (const double value : {p.x, p.y, p.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z, w.x, w.y, w.z})
            std::fprintf(file_, ",%.17g", value);
        std::fputc('\n', file_);
    }
}

void PosesFile::close() {
    const bool failed = std::ferror(file_) != 0;
    if (std::fclose(std::exchange(file_, nullptr)) != 0 || failed) throw IoError(path_.string() + ": cannot write");
}

} // namespace flotilla::baseline
