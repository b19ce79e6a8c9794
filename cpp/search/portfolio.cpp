#include "search/portfolio.hpp"

#include <algorithm>

namespace explicable {

Status Portfolio::run(Monitor& monitor, std::int64_t slice) {
    const std::int64_t end = end_of_slice(monitor, slice);
    while (std::any_of(members_.begin(), members_.end(), [](const Member& member) { return member.slice > 0; })) {
        Member& member = members_[turn_];
        if (member.slice > 0) {
            auto& engine = engines_[turn_];
            if (!engine) engine = member.make();
            const Status status = engine->run(monitor, std::min(member.slice, end - monitor.evaluations));
            if (status == Status::solved || status == Status::stopped) return status;
            if (status == Status::exhausted && engine->is_complete()) {
                is_complete_ = true;
                return status;
            }
            if (status == Status::paused && monitor.evaluations >= end) return status;
            member.slice = status == Status::exhausted ? 0 : member.slice * member.growth;
            if (member.slice == 0) engine.reset();
        }
        turn_ = (turn_ + 1) % members_.size();
    }
    return Status::exhausted;
}

std::size_t Portfolio::memory_bytes() const {
    std::size_t sum = 0;
    for (const auto& engine : engines_) sum += engine ? engine->memory_bytes() : 0;
    return sum;
}

}  // namespace explicable
