// Lazy greedy best-first search with preferred operators (Richter & Helmert 2009).
#pragma once

#include <limits>
#include <vector>

#include "search/evaluator.hpp"
#include "search/open_list.hpp"

namespace explicable {

class LazySearch : public Engine {
public:
    LazySearch(const Question& question, Preferred preferred, LabelledOptions labelled, std::uint64_t seed);

    Status run(Monitor& monitor, std::int64_t slice) override;
    std::vector<OperatorId> plan() const override { return nodes_.path(goal_node_); }
    std::size_t memory_bytes() const override {
        return nodes_.memory_bytes() + all_.memory_bytes() + promising_.memory_bytes();
    }

private:
    struct Edge {
        NodeId parent;
        OperatorId step;
    };

    const Question& question_;
    Preferred preferred_;
    NodeStore nodes_;
    Evaluator evaluator_;
    TieBreaker ties_;
    OpenList<Edge> all_, promising_;
    std::int64_t all_priority_ = 0, promising_priority_ = 0;  // the lower one is served
    double best_h_ = std::numeric_limits<double>::infinity();
    NodeId goal_node_ = -1;
    State state_;
    std::vector<OperatorId> applicable_, marked_;
    std::vector<Edge> edges_;
    bool started_ = false;

    Edge next_edge();
    bool visit(NodeId node, Monitor& monitor);
    void push(OpenList<Edge>& open, const Key& key, NodeId node, const std::vector<OperatorId>& operators);
};

}  // namespace explicable
