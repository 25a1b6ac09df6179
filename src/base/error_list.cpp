// SPDX-License-Identifier: MIT
#include "base/error_list.hpp"

#include <algorithm>

namespace flotilla {

void ErrorList::add(std::string where, std::string reason) {
    for (std::size_t end = where.size(); end != std::string::npos && end > 0; end = where.rfind('/', end - 1))
        places_.insert(where.substr(0, end));
    places_.insert("");
    exact_places_.insert(where);
    problems_.push_back({std::move(where), std::move(reason)});
}

std::string ErrorList::message() const {
    std::string text;
    const std::size_t shown = std::min(problems_.size(), kMaxLines);
    for (std::size_t i = 0; i < shown; ++i) {
        if (i > 0) text += '\n';
        text += source_ + ": ";
        if (!problems_[i].where.empty()) text += problems_[i].where + ": ";
        text += problems_[i].reason;
    }
    if (shown < problems_.size())
        text += '\n' + source_ + ": and " + std::to_string(problems_.size() - shown) + " more problems";
    return text;
}

void ErrorList::throw_if_any() const {
    if (!empty()) throw InputError(message(), problems_);
}

} // namespace flotilla
