#include "search/width.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <new>

namespace explicable {

namespace {

constexpr int least_pair_bits = 20, most_pair_bits = 29;  // logarithms: 128 KiB to 64 MiB
constexpr std::size_t most_pairs = std::size_t{1} << 20;  // entered for one state

}  // namespace

void NoveltyTable::Free::operator()(std::uint64_t* words) const { std::free(words); }

NoveltyTable::NoveltyTable(std::int32_t num_facts) : num_facts_(num_facts) {
    const auto pairs = static_cast<std::uint64_t>(num_facts) * static_cast<std::uint64_t>(num_facts) * 32 + 1;
    num_pair_bits_ = std::size_t{1} << std::clamp(static_cast<int>(std::bit_width(pairs)), least_pair_bits, most_pair_bits);
    // calloc, since pages that are never touched then cost nothing.
    pairs_seen_.reset(static_cast<std::uint64_t*>(std::calloc(num_pair_bits_ / 64, sizeof(std::uint64_t))));
    if (!pairs_seen_) throw std::bad_alloc();
}

int NoveltyTable::novelty(std::uint32_t state_class, std::span<const FactId> added, std::span<const FactId> by_last_step,
                          std::span<const FactId> facts) {
    if (state_class >= facts_seen_.size()) facts_seen_.resize(state_class + 1);
    auto& seen = facts_seen_[state_class];
    if (seen.empty()) seen.resize(num_facts_);
    bool new_fact = false, new_pair = false;
    for (const FactId fact : added) {
        new_fact |= !seen[fact];
        seen[fact] = true;
    }
    if (new_fact) return 1;
    if (added.size() * facts.size() > most_pairs) added = by_last_step;
    for (const FactId fact : added) {
        for (const FactId other : facts) new_pair |= enter_pair(state_class, fact, other);
    }
    return new_pair ? 2 : 3;
}

bool NoveltyTable::enter_pair(std::uint32_t state_class, FactId a, FactId b) {
    if (a > b) std::swap(a, b);
    std::uint64_t hash = (static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b)) * 0x9e3779b97f4a7c15ULL;
    hash = (hash ^ hash >> 32 ^ state_class) * 0xff51afd7ed558ccdULL;
    const std::size_t bit = (hash >> 20) & (num_pair_bits_ - 1);
    std::uint64_t& word = pairs_seen_[bit / 64];
    const std::uint64_t mask = std::uint64_t{1} << bit % 64;
    const bool is_new = !(word & mask);
    word |= mask;
    return is_new;
}

std::size_t NoveltyTable::memory_bytes() const {
    return num_pair_bits_ / 8 + facts_seen_.size() * (static_cast<std::size_t>(num_facts_) / 8 + 24);
}

WidthSearch::WidthSearch(const Question& question, std::uint64_t seed)
    : question_(question),
      nodes_(question.task, nullptr, Closing::state),
      planner_(question.prepared, question.goal, SupporterCost::unit),
      ties_(seed),
      novelty_(question.task.num_facts()),
      place_(question.task.num_facts(), -1),
      classes_(question.goal.size() + 1) {}

Status WidthSearch::run(Monitor& monitor, std::int64_t slice) {
    if (goal_node_ >= 0) return Status::exhausted;
    const std::int64_t end = end_of_slice(monitor, slice);
    if (!started_) {
        started_ = true;
        if (admit(nodes_.add_root(question_.initial), -1, monitor)) return Status::solved;
    }
    while (!open_.empty()) {
        if (!monitor.may_go_on([this] { return memory_bytes(); })) return Status::stopped;
        if (monitor.evaluations >= end) return Status::paused;
        const NodeId node = open_.pop();
        ++monitor.expansions;
        nodes_.state(node, state_);
        question_.successors.applicable(state_, applicable_);
        ties_.shuffle(applicable_);
        for (const OperatorId step : applicable_) {
            const auto arrival = nodes_.add(node, step);
            if (arrival.is_new && admit(arrival.node, node, monitor)) return Status::solved;
        }
    }
    return Status::exhausted;
}

// Files a new node, unless it is a dead end; true if it is a goal.
bool WidthSearch::admit(NodeId node, NodeId parent, Monitor& monitor) {
    ++monitor.evaluations;
    nodes_.state(node, child_);
    facts_.clear();
    added_.clear();
    for (VariableId variable = 0; variable < question_.task.num_variables(); ++variable) {
        const std::int32_t value = child_.values[variable];
        if (value == 0) continue;
        const FactId fact = question_.task.variable_facts[variable][value - 1];
        facts_.push_back(fact);
        if (parent < 0 || state_.values[variable] != value) added_.push_back(fact);
    }
    const std::int32_t num_open = count_open_goals(child_);
    if (num_open == 0) {
        goal_node_ = node;
        return true;
    }
    bool dead = false;
    if (parent < 0 || num_open < progress_[parent].num_open) {
        dead = !set_anchor(num_open);
    } else {
        inherit(parent, num_open);
    }
    if (dead) return false;
    const Progress& progress = progress_.back();
    const std::uint32_t state_class = class_of(progress);
    const bool same_class = parent >= 0 && class_of(progress_[parent]) == state_class;
    const int novelty = novelty_.novelty(state_class, same_class ? added_ : facts_, added_, facts_);
    open_.push({static_cast<double>(novelty), static_cast<double>(num_open)}, node);
    return false;
}

// Makes a relaxed plan from child_; false if there is none.
bool WidthSearch::set_anchor(std::int32_t num_open) {
    std::vector<FactId> facts;
    const bool reachable = planner_.compute(child_);
    if (reachable) {
        for (const OperatorId step : planner_.plan()) {
            for (const FactId fact : question_.task.adds[step]) {
                if (!child_.holds(question_.task, fact)) facts.push_back(fact);
            }
        }
        std::sort(facts.begin(), facts.end());
        facts.erase(std::unique(facts.begin(), facts.end()), facts.end());
    }
    progress_.push_back({static_cast<std::int32_t>(anchors_.size()), num_open, 0, reached_.size()});
    reached_.resize(reached_.size() + (facts.size() + 63) / 64, 0);
    anchors_.push_back(std::move(facts));
    return reachable;
}

void WidthSearch::inherit(NodeId parent, std::int32_t num_open) {
    Progress progress = progress_[parent];
    progress.num_open = num_open;
    place_anchor(progress.anchor);
    bool copied = false;
    for (const FactId fact : added_) {
        const std::int32_t place = place_[fact];
        if (place < 0) continue;
        const std::uint64_t mask = std::uint64_t{1} << place % 64;
        if (reached_[progress.reached + place / 64] & mask) continue;
        if (!copied) {
            const std::size_t num_words = (anchors_[progress.anchor].size() + 63) / 64, from = progress.reached;
            progress.reached = reached_.size();
            for (std::size_t i = 0; i < num_words; ++i) reached_.push_back(reached_[from + i]);
            copied = true;
        }
        reached_[progress.reached + place / 64] |= mask;
        ++progress.num_reached;
    }
    progress_.push_back(progress);
}

void WidthSearch::place_anchor(std::int32_t anchor) {
    if (anchor == placed_anchor_) return;
    if (placed_anchor_ >= 0) {
        for (const FactId fact : anchors_[placed_anchor_]) place_[fact] = -1;
    }
    for (std::size_t i = 0; i < anchors_[anchor].size(); ++i) place_[anchors_[anchor][i]] = static_cast<std::int32_t>(i);
    placed_anchor_ = anchor;
}

std::uint32_t WidthSearch::class_of(const Progress& progress) {
    auto& row = classes_[progress.num_open];
    const auto column = static_cast<std::size_t>(progress.num_reached);
    if (column >= row.size()) row.resize(column + 1, 0);
    if (row[column] == 0) row[column] = ++num_classes_;
    return row[column] - 1;
}

std::int32_t WidthSearch::count_open_goals(const State& state) const {
    std::int32_t num_open = 0;
    for (const FactId fact : question_.goal) num_open += !state.holds(question_.task, fact);
    return num_open;
}

std::size_t WidthSearch::memory_bytes() const {
    return nodes_.memory_bytes() + open_.memory_bytes() + novelty_.memory_bytes() +
           progress_.capacity() * sizeof(Progress) + reached_.capacity() * sizeof(std::uint64_t);
}

}  // namespace explicable
