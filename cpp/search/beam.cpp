#include "search/beam.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace explicable {

bool search_beam(const Question& question, Closing closing, const Outlook& outlook, std::size_t width, Monitor& monitor,
                 Incumbent& best) {
    NodeStore nodes(question.task, best.scorer, closing, best.alpha, best.limits_cost());
    std::vector<std::pair<double, NodeId>> layer, next;
    std::vector<OperatorId> applicable;
    State state;
    layer.emplace_back(0.0, nodes.add_root(question.initial));
    while (!layer.empty()) {
        next.clear();
        for (const auto& [promise, node] : layer) {
            if (!monitor.may_go_on([&] { return outlook.memory_bytes() + nodes.memory_bytes(); })) return false;
            if (nodes.is_dominated(node)) continue;
            ++monitor.expansions;
            nodes.state(node, state);
            question.successors.applicable(state, applicable);
            for (const OperatorId step : applicable) {
                const auto arrival = nodes.add(node, step);
                if (!arrival.is_new) continue;
                ++monitor.evaluations;
                const double ahead = outlook(nodes.words(arrival.node), nodes.context(arrival.node));
                const double value = nodes.spent(arrival.node) +
                                     best.penalty({nodes.path_count(arrival.node), 0.0, nodes.path_steps(arrival.node)});
                if (value + ahead >= best.objective - rounding || !outlook.affords(nodes.cost(arrival.node), nodes.words(arrival.node))) continue;
                nodes.state(arrival.node, state);
                if (question.is_goal(state)) best.offer(nodes.path(arrival.node), question);
                next.emplace_back(value + ahead, arrival.node);
            }
        }
        if (next.size() > width) {  // ties by age
            std::nth_element(next.begin(), next.begin() + static_cast<std::ptrdiff_t>(width), next.end());
            next.resize(width);
        }
        std::ranges::sort(next);
        layer.swap(next);
    }
    return monitor.stop() == Stop::none;
}

}  // namespace explicable
