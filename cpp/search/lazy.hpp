// Lazy greedy best-first search with preferred operators (Richter & Helmert 2009) and look-ahead (Vidal 2004).
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "search/evaluator.hpp"
#include "search/lookahead.hpp"
#include "search/open_list.hpp"

namespace explicable {

class LazySearch : public Engine {
public:
    // With look-ahead, the node that a node's relaxed plan leads to comes next.
    LazySearch(const Question& question, Preferred preferred, LabelledOptions labelled, std::uint64_t seed,
               Ahead ahead);

    Status run(Monitor& monitor, std::int64_t slice) override;
    std::vector<OperatorId> plan() const override { return nodes_.path(goal_node_); }
    std::size_t memory_bytes() const override {
        return nodes_.memory_bytes() + all_.memory_bytes() + promising_.memory_bytes() + visited_.capacity() / 8;
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
    std::optional<Lookahead> lookahead_;
    OpenList<Edge> all_, promising_;
    std::int64_t all_priority_ = 0, promising_priority_ = 0;  // the lower one is served
    double best_h_ = std::numeric_limits<double>::infinity();
    std::vector<bool> visited_;  // nodes; those on the way of a look-ahead are not, at first
    NodeId next_ = -1;           // comes before all edges
    NodeId goal_node_ = -1;
    State state_;
    std::vector<OperatorId> applicable_, marked_;
    std::vector<Edge> edges_;
    bool started_ = false;

    bool is_visited(NodeId node) const { return static_cast<std::size_t>(node) < visited_.size() && visited_[node]; }
    NodeId follow_edge();
    bool visit(NodeId node, Monitor& monitor);
    void push(OpenList<Edge>& open, const Key& key, NodeId node, const std::vector<OperatorId>& operators);
};

}  // namespace explicable
