// What a scorer can say of all continuations of a path at once: bounds from how little one label moves its neighbours.
#include <cmath>
#include <limits>

#include "labelling/scorer.hpp"

namespace explicable {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

double probability(double log_odds) { return 1 / (1 + std::exp(-log_odds)); }

// A robot's step is inexplicable on the most probable labels only if its log odds exceed 0; rounding must not decide.
constexpr double kTie = 1e-9;

}  // namespace

// The message of a label's neighbour is log (e^T(i,0) + z e^T(i,1)), z >= 0 unknown: its difference between labels lies between
// the two differences of transition weights. The same holds with max in the place of the sum.
void Scorer::find_bounds() {
    const auto& t = transitions_;
    from_before_ = {std::min(t[0][1] - t[0][0], t[1][1] - t[1][0]), std::max(t[0][1] - t[0][0], t[1][1] - t[1][0])};
    from_human_ = t[1][0] - t[0][0];
    from_robot_ = {std::min(from_human_, t[1][1] - t[0][1]), std::max(from_human_, t[1][1] - t[0][1])};
    const double attraction = t[0][0] + t[1][1] - t[0][1] - t[1][0];
    is_attractive_ = attraction >= 0;
    // A shift of log odds by x moves a probability by tanh(x / 4) at most; so it goes on from label to label.
    coupling_ = std::tanh(std::abs(attraction) / 4);
    for (const double weight : returns_) {
        returns_least_ = std::min(returns_least_, weight);
        returns_effect_ = std::max(returns_effect_, std::abs(weight));
    }
    for (std::size_t schema = 0; schema < num_schemas_; ++schema) {
        const auto before = [this, schema](std::size_t next) { return schemas_[next * (num_schemas_ + 1) + schema].of_last; };
        Span span{before(num_schemas_), before(num_schemas_)};
        for (std::size_t next = 0; next < num_schemas_; ++next) {
            Span equalities{before(next), before(next)};
            for (std::size_t i = 0; i < std::min(tables_->arity[next], kMaxArguments); ++i)
                for (std::size_t j = 0; j < std::min(tables_->arity[schema], kMaxArguments); ++j) {
                    const double weight = same_.weight(next, schema, i, j).of_last;
                    (weight < 0 ? equalities.least : equalities.greatest) += weight;
                }
            span.cover(equalities.least);
            span.cover(equalities.greatest);
        }
        look_.push_back(span);
    }
    for (std::size_t last = 0; last < kNumNeighbours; ++last) {
        Span& span = outlook_[last] = {beside_[last].of_last, beside_[last].of_last};
        for (std::size_t next = 1; next < kNumNeighbours; ++next) span.cover(beside_[next * kNumNeighbours + last].of_last);
    }
}

// What the step after the last, a robot's, can add to the score of the last.
Scorer::Span Scorer::look_ahead_span(const Situation& situation) const {
    Span span = look_[schema_of(situation.last)];
    const Span& outlook = outlook_[static_cast<std::size_t>(situation.neighbour)];
    span.least += outlook.least;
    span.greatest += outlook.greatest;
    return span;
}

// What a label hears from a neighbour to the right whose own log odds, from its score and from further right, are `z`.
double Scorer::from_right(double z) const {
    const auto& t = transitions_;
    const auto sum = [this](double a, double b) {
        const double larger = std::max(a, b);
        return expected_ ? larger + std::log1p(std::exp(-std::abs(a - b))) : larger;
    };
    return sum(t[1][0], t[1][1] + z) - sum(t[0][0], t[0][1] + z);
}

Scorer::Span Scorer::from_last(const Context& context) const {
    if (is_human(context.situation.last)) return {from_human_, from_human_};
    const Span look = look_ahead_span(context.situation);
    const double a = from_right(context.pending + look.least + std::min({0.0, from_human_, from_robot_.least}));
    const double b = from_right(context.pending + look.greatest + std::max({0.0, from_human_, from_robot_.greatest}));
    return {std::min(a, b), std::max(a, b)};
}

double Scorer::least_count(const std::byte* bytes) const {
    const Context context = read(bytes);
    const auto& chain = context.chain;
    if (context.num_steps == 0 || chain.is_empty) return 0;
    const Span right = from_last(context);
    if (!expected_) {
        double least = kUnknown;
        if (!(chain.odds + right.least > kTie)) least = chain.count[0];
        if (chain.odds + right.greatest > -kTie) least = std::min(least, chain.count[1]);
        return least;
    }
    const auto mean = [&chain](double heard) {
        const double other = chain.odds * std::exp(heard), share = other / (1 - chain.odds + other);
        return chain.count[0] + share * (chain.count[1] - chain.count[0]);
    };
    return std::min(mean(right.least), mean(right.greatest));
}

// Of the last step, whatever comes before.
double Scorer::least_inexplicable(const Context& context, double look_ahead, double heard) const {
    if (context.num_steps == 0 || is_human(context.situation.last)) return 0;
    const double before = context.chain.is_empty ? 0 : from_before_.least;
    const double log_odds = context.pending + returns_least_ + look_ahead + before + heard;
    return expected_ ? probability(log_odds) : log_odds > kTie;
}

double Scorer::least_growth(const std::byte* parent, OperatorId step, const std::byte* child) const {
    if ((*tables_)[step].schema < 0) return 0;
    const Context before = read(parent), after = read(child);
    if (before.num_steps == 0 || is_human(before.situation.last)) return 0;
    double heard = from_human_;
    if (!is_human(step)) {
        const double z = after.pending + returns_least_ + look_ahead_span(after.situation).least +
                         std::min({0.0, from_human_, from_robot_.least});
        heard = is_attractive_ ? from_right(z) : from_robot_.least;
    }
    return least_inexplicable(before, look_ahead(before.situation, step, after.situation.neighbour), heard);
}

double Scorer::least_end(const std::byte* bytes) const {
    const Context context = read(bytes);
    if (context.num_steps == 0 || is_human(context.situation.last)) return 0;
    return least_inexplicable(context, look_ahead(context.situation, -1, kNothing), 0);
}

std::uint64_t Scorer::outlook_key(const std::byte* bytes) const {
    const Context context = read(bytes);
    return combine(situation_key(context), static_cast<std::uint64_t>(context.chain.is_empty));
}

// Forgets what the outlook key leaves out: which steps may be taken back later, and all of the chain.
void Scorer::widen(std::byte* bytes, const std::byte* other) const {
    Context context = read(bytes);
    context.pending = std::min(context.pending, read(other).pending);
    std::fill(context.situation.robot_steps.begin() + 1, context.situation.robot_steps.end(), -1);
    std::memcpy(bytes, &context, sizeof context);
}

// The features of what follows are the same for both, but for steps that can still be taken back.
double Scorer::effect_of_history(const Situation& a, const Situation& b) const {
    if (!uses_returns_) return 0;
    for (int i = 1; i < kRecentSteps; ++i) {
        if (a.robot_steps[i] == b.robot_steps[i]) continue;
        // Seen by so many further steps, in whose scores the expected count is steep to this degree at most.
        if (!expected_ || coupling_ > 1 - 1e-6) return kUnknown;
        return (kRecentSteps - i) * returns_effect_ * (1 + coupling_) / (1 - coupling_) / 4;
    }
    return 0;
}

double Scorer::lead(const std::byte* first, const std::byte* second, const State&) const {
    Context a = read(first), b = read(second);
    if (a.num_steps == 0 || b.num_steps == 0) return a.num_steps == b.num_steps ? 0 : kUnknown;
    const bool human = is_human(a.situation.last);
    append(a.chain, a.pending);
    append(b.chain, b.pending);
    if (human) return a.chain.count[0] - b.chain.count[0] + effect_of_history(a.situation, b.situation);
    const double at_end = look_ahead(a.situation, -1, kNothing);
    Span right = look_ahead_span(a.situation);
    right.least += std::min(from_human_, from_robot_.least);
    right.greatest += std::max(from_human_, from_robot_.greatest);
    if (!expected_) {
        right.cover(at_end);
        return lead_best(a.chain, b.chain, right) + effect_of_history(a.situation, b.situation);
    }
    // So strong a coupling carries any difference on without end.
    if (coupling_ > 1 - 1e-6 && a.chain.odds != b.chain.odds) return kUnknown;
    const double ahead = coupling_ > 1 - 1e-6 ? 0 : coupling_ / (1 - coupling_);
    const double going_on = lead_expected(a.chain, b.chain, right, {is_attractive_ ? 0 : -ahead, ahead});
    return std::max(lead_expected(a.chain, b.chain, {at_end, at_end}, {0, 0}),
                    going_on + effect_of_history(a.situation, b.situation));
}

// The count is (1 - q) (c0 + f0) + q (c1 + f1): q = P(last inexplicable) given all, f = counts ahead. With r the odds heard from
// the right, q = p r / (1 - p + p r). The greatest difference over r and f1 - f0 is at an end, or where its derivative is 0.
double Scorer::lead_expected(const Chain& a, const Chain& b, const Span& right, const Span& ahead) const {
    const double pa = a.odds, pb = b.odds;
    const double least = std::exp(right.least), greatest = std::exp(right.greatest);
    double lead = -kUnknown;
    for (const double more : {ahead.least, ahead.greatest}) {
        const double sa = a.count[1] - a.count[0] + more, sb = b.count[1] - b.count[0] + more;
        const auto at = [&](double r) {
            lead = std::max(lead, a.count[0] - b.count[0] + sa * (pa * r / (1 - pa + pa * r)) -
                                      sb * (pb * r / (1 - pb + pb * r)));
        };
        at(least);
        at(greatest);
        const double steepness = sb * pb * (1 - pb) / (sa * pa * (1 - pa));
        if (!(steepness > 0)) continue;
        const double k = std::sqrt(steepness), r = (k * (1 - pa) - (1 - pb)) / (pb - k * pa);
        if (r > least && r < greatest) at(r);
    }
    return lead;
}

// On the most probable labels. If like labels attract, then higher odds here never make a label ahead explicable.
double Scorer::lead_best(const Chain& a, const Chain& b, const Span& right) const {
    if (a.odds != b.odds && !(is_attractive_ && a.odds < b.odds)) return kUnknown;
    const auto can_be = [&right](const Chain& chain, int label) {
        return label == 1 ? chain.odds + right.greatest > -kTie : chain.odds + right.least <= kTie;
    };
    double lead = -kUnknown;
    for (int i = 0; i < 2; ++i)
        for (int j = i; j < 2; ++j)
            if ((i == j || a.odds != b.odds) && can_be(a, i) && can_be(b, j))
                lead = std::max(lead, a.count[i] - b.count[j]);
    return lead;
}

}  // namespace explicable
