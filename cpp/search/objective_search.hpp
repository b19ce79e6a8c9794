// Search for the plan of least J, with lower bounds of what lies ahead.
#pragma once

#include <vector>

#include "search/engine.hpp"
#include "search/improve.hpp"
#include "search/node_store.hpp"
#include "search/open_list.hpp"
#include "search/outlook.hpp"

namespace explicable {

// A* for J: a node's bound is its cost, alpha times the inexplicable steps that its path will have at the least, and the least
// that lies ahead (outlook.hpp). For a ratio, whose parts don't add up, the bound is of the cost alone.
class ObjectiveSearch {
public:
    ObjectiveSearch(const Question& question, const Incumbent& best, Closing closing, const Outlook& outlook, double weight)
        : question_(question),
          scorer_(*best.scorer),
          price_(best.ratio ? 0.0 : best.alpha),
          weight_(weight),
          outlook_(outlook),
          nodes_(question.task, best.scorer, closing, best.alpha, best.limits_cost()) {}

    // Exhausted: the best plan is optimal, to within `gap` of its objective. Paused: the slice is used up.
    Status run(Monitor& monitor, std::int64_t slice, double gap, Incumbent& best);
    double lower_bound(const Incumbent& best) const {
        return open_.empty() ? best.objective : std::min(open_.lowest().first, best.objective);
    }
    std::size_t memory_bytes() const { return outlook_.memory_bytes() + nodes_.memory_bytes() + open_.memory_bytes(); }

private:
    struct Open {
        NodeId node;
        double bound;
    };

    const Question& question_;
    const PathScorer& scorer_;
    double price_, weight_;
    const Outlook& outlook_;
    NodeStore nodes_;
    OpenList<Open> open_;
    State state_, child_;
    std::vector<OperatorId> applicable_;

    void file(NodeId node, Monitor& monitor, Incumbent& best);
};

}  // namespace explicable
