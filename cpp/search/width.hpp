// Best-first width search BFWS(f5) (Lipovetzky & Geffner 2017): novelty first, then the number of open goals.
#pragma once

#include <memory>
#include <vector>

#include "search/engine.hpp"
#include "search/node_store.hpp"
#include "search/open_list.hpp"
#include "search/relaxed_plan.hpp"

namespace explicable {

// Has a fact, or a pair of facts, been seen before in a class of states? Pairs are hashed into a fixed number of bits, so that
// now and then a new one counts as seen: this changes the order of the search, not its completeness.
class NoveltyTable {
public:
    explicit NoveltyTable(std::int32_t num_facts);

    // 1: some fact of `added` is new in the class; 2: some pair with a fact of `added` is; else 3. Enters the facts and, unless
    // a fact is new, the pairs: to enter them always costs much in a class that has just begun, and gains little. Where there
    // would be too many, only those with the facts added by the last step.
    int novelty(std::uint32_t state_class, std::span<const FactId> added, std::span<const FactId> by_last_step,
                std::span<const FactId> facts);
    std::size_t memory_bytes() const;

private:
    std::int32_t num_facts_;
    std::vector<std::vector<bool>> facts_seen_;  // by class
    struct Free {
        void operator()(std::uint64_t* words) const;
    };
    std::unique_ptr<std::uint64_t[], Free> pairs_seen_;
    std::size_t num_pair_bits_;

    bool enter_pair(std::uint32_t state_class, FactId a, FactId b);
};

class WidthSearch : public Engine {
public:
    WidthSearch(const Question& question, std::uint64_t seed);

    Status run(Monitor& monitor, std::int64_t slice) override;
    std::vector<OperatorId> plan() const override { return nodes_.path(goal_node_); }
    std::size_t memory_bytes() const override;

private:
    // Where the number of open goals fell last, a relaxed plan was made; its facts count as they are reached.
    struct Progress {
        std::int32_t anchor;     // which relaxed plan
        std::int32_t num_open;   // goals
        std::int32_t num_reached;
        std::size_t reached;     // bits of the anchor's facts, in reached_
    };

    const Question& question_;
    NodeStore nodes_;
    RelaxedPlanner planner_;
    TieBreaker ties_;
    NoveltyTable novelty_;
    OpenList<NodeId> open_;
    std::vector<Progress> progress_;
    std::vector<std::uint64_t> reached_;
    std::vector<std::vector<FactId>> anchors_;  // facts of each relaxed plan
    std::vector<std::int32_t> place_;           // of a fact in the anchor at hand, or -1
    std::int32_t placed_anchor_ = -1;
    std::vector<std::vector<std::uint32_t>> classes_;  // number of the class, by open goals and reached facts
    std::uint32_t num_classes_ = 0;
    NodeId goal_node_ = -1;
    State state_, child_;
    std::vector<OperatorId> applicable_;
    std::vector<FactId> added_, facts_;
    bool started_ = false;

    bool admit(NodeId node, NodeId parent, Monitor& monitor);
    bool set_anchor(std::int32_t num_open);
    void inherit(NodeId parent, std::int32_t num_open);
    void place_anchor(std::int32_t anchor);
    std::uint32_t class_of(const Progress& progress);
    std::int32_t count_open_goals(const State& state) const;
};

}  // namespace explicable
