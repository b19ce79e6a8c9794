// What a person does next is a choice: to wait or to act, and then one of the human steps that are possible.
// A conditional logit over lifted features says how probable each is (docs/method.md, section 2).
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "labelling/team_tables.hpp"
#include "task/state.hpp"

namespace explicable {

// The order of `HUMAN_FEATURES` in situations.py.
enum class HumanFeature : int {
    kWaitsNothingOpen,
    kWaitsRequestOpen,
    kAsksForNothing,
    kSeemsImpossible,
    kRank,  // of the distance of what is asked for, among all that could be asked for
    kNearest,
    kRepeats,
};
inline constexpr std::size_t kNumHumanFeatures = 7;
using HumanWeights = std::array<double, kNumHumanFeatures>;

// One of the human steps that are possible.
struct HumanOption {
    OperatorId step;        // the first operator of the action
    std::int32_t request;   // or -1
    Distance distance;      // of what is asked for, as the person sees it
    std::int32_t rank;      // among the distances of all options, the least being 0
    bool repeats;           // an open request
    bool is_nearest() const { return rank == 0; }
};

class HumanChoices {
public:
    HumanChoices(const Task& composite, const Task& mental, const MentalNames& names,
                 std::shared_ptr<const TeamTables> tables);

    // The human steps that are possible in a state; `open` are the open requests.
    void list(const State& state, std::span<const std::int32_t> open, std::vector<HumanOption>& options) const;

    // -log of the probability that, before `step`, the person acts as the plan says: takes just this step if it is a human's,
    // else waits. 0 where no human step is possible.
    double surprise(const HumanWeights& weights, const State& state, std::span<const std::int32_t> open,
                    OperatorId step) const;

private:
    // A fact that must hold before a request can be fulfilled, and how far from it each value of its variable is.
    struct Need {
        VariableId variable;
        std::vector<Distance> by_value;
    };
    using Way = std::vector<std::int32_t>;  // numbers of needs

    const Task& task_;
    std::shared_ptr<const TeamTables> tables_;
    std::vector<std::vector<OperatorId>> actions_;  // a human's: several operators if its precondition is a disjunction
    std::vector<std::int32_t> action_of_;           // of an operator; -1 if it is not a human's
    std::vector<Need> needs_;
    std::vector<std::vector<Way>> ways_;  // of each request

    Distance distance(const State& state, std::int32_t request) const;
    bool is_possible(const State& state, const std::vector<OperatorId>& action) const;
};

}  // namespace explicable
