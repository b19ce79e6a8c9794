// Eager best-first search by f = weight_g * g + weight_h * h: greedy search, A*, weighted A*.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "search/evaluator.hpp"
#include "search/heuristics.hpp"
#include "search/open_list.hpp"

namespace explicable {

struct BestFirstOptions {
    double weight_g = 0.0, weight_h = 1.0;
    std::unique_ptr<AdmissibleHeuristic> admissible;          // null: the FF heuristic
    SupporterCost supporter_cost = SupporterCost::unit;       // of the FF heuristic
    Preferred preferred = Preferred::none;                    // with the FF heuristic only
    bool reopen = false;                                      // when a state is reached at lower cost
    double bound = std::numeric_limits<double>::infinity();   // plans that cost so much are of no interest
    LabelledOptions labelled;                                 // with the FF heuristic only
    std::uint64_t seed = 0;
};

class BestFirstSearch : public Engine {
public:
    BestFirstSearch(const Question& question, BestFirstOptions options);

    Status run(Monitor& monitor, std::int64_t slice) override;
    std::vector<OperatorId> plan() const override { return nodes_.path(goal_node_); }
    std::size_t memory_bytes() const override {
        return nodes_.memory_bytes() + all_.memory_bytes() + promising_.memory_bytes() + h_.capacity() * sizeof(double);
    }
    // With weights of 1 and an admissible heuristic: what no plan can cost less than.
    double lower_bound() const {
        if (!started_) return 0.0;
        return all_.empty() ? options_.bound : std::min(all_.lowest().first, options_.bound);
    }
    void set_bound(double bound) { options_.bound = std::min(options_.bound, bound); }

private:
    const Question& question_;
    BestFirstOptions options_;
    NodeStore nodes_;
    std::optional<Evaluator> evaluator_;  // the FF heuristic
    TieBreaker ties_;
    OpenHeap<NodeId> all_, promising_;
    std::int64_t all_priority_ = 0, promising_priority_ = 0;
    double best_h_ = std::numeric_limits<double>::infinity();
    std::vector<double> h_;
    std::vector<bool> expanded_;
    std::vector<char> is_marked_;  // by operator: preferred in the node that is being expanded
    NodeId goal_node_ = -1;
    State state_;
    std::vector<OperatorId> applicable_, marked_;
    bool started_ = false;

    NodeId next_node();
    void evaluate(NodeId node, Monitor& monitor);
    void push(NodeId node, bool promising);
    void expand(NodeId node, Monitor& monitor);
    Key key(NodeId node) const;
    double least_cost(NodeId node) const;
};

}  // namespace explicable
