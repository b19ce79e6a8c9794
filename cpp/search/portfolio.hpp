// Engines made of engines.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "search/engine.hpp"

namespace explicable {

// Runs its members in turn, each for a slice of evaluations that grows from round to round, until one of them has a plan.
// A member is made when its first turn comes; one that is exhausted without proving anything drops out.
class Portfolio : public Engine {
public:
    struct Member {
        std::function<std::unique_ptr<Engine>()> make;
        std::int64_t slice;   // evaluations in the first round
        std::int64_t growth;  // of the slice from round to round; 0: the member has one turn only
    };

    explicit Portfolio(std::vector<Member> members) : members_(std::move(members)), engines_(members_.size()) {}

    Status run(Monitor& monitor, std::int64_t slice) override;
    std::vector<OperatorId> plan() const override { return engines_[turn_]->plan(); }
    std::size_t memory_bytes() const override;
    bool is_complete() const override { return is_complete_; }

private:
    std::vector<Member> members_;
    std::vector<std::unique_ptr<Engine>> engines_;
    std::size_t turn_ = 0;
    bool is_complete_ = false;
};

}  // namespace explicable
