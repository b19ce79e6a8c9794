#include "labelling/feature_weights.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace explicable {

namespace {

// As Template.is_optional in templates.py.
bool is_optional(Template feature_template) {
    switch (feature_template) {
        case Template::kSameAfter:
        case Template::kSameBefore:
        case Template::kSameHuman:
        case Template::kUndoes:
        case Template::kReturns:
        case Template::kUnbelieved: return true;
        default: return false;
    }
}

}  // namespace

FeatureWeights::FeatureWeights(int num_schemas, std::size_t max_arity, double unfamiliar) {
    if (!std::isfinite(unfamiliar)) throw std::invalid_argument("a weight is not finite");
    const auto schemas = static_cast<std::size_t>(num_schemas), neighbours = schemas + 1;  // or nothing
    const std::size_t arguments = std::min(max_arity, kMaxArguments);
    const std::size_t progress = kNumProgress, beside = kNumNeighbours;
    dimensions_ = {
        {schemas},                                    // step
        {schemas, neighbours},                        // after
        {schemas, neighbours},                        // before
        {schemas, schemas, arguments, arguments},     // same as after
        {schemas, schemas, arguments, arguments},     // same as before
        {schemas, schemas, arguments, arguments},     // same as the last human step
        {schemas},                                    // undoes
        {schemas},                                    // returns
        {schemas},                                    // unbelieved
        {schemas, progress},                          // request, mental
        {schemas, progress},                          // request, own
        {schemas, progress},                          // nearest goal, mental
        {schemas, progress},                          // nearest goal, own
        {schemas, progress},                          // mission
        {progress, progress},                         // request, mental and own
        {progress, progress},                         // request and mission
        {progress, beside},                           // trend
        {progress, beside},                           // outlook
    };
    if (schemas > 1000) throw std::length_error("more than 1000 action schemas");
    for (const auto& sizes : dimensions_) {
        std::size_t size = 1;
        for (const auto dimension : sizes) size *= dimension;
        tables_.emplace_back(size, is_optional(static_cast<Template>(tables_.size())) ? 0.0 : unfamiliar);
    }
}

void FeatureWeights::set(int feature_template, std::span<const std::int32_t> values, double weight) {
    if (feature_template < 0 || feature_template >= kNumTemplates) throw std::invalid_argument("no such template");
    const auto& sizes = dimensions_[static_cast<std::size_t>(feature_template)];
    if (values.size() < sizes.size()) throw std::invalid_argument("a feature has too few values");
    if (!std::isfinite(weight)) throw std::invalid_argument("a weight is not finite");
    std::size_t index = 0;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        if (values[i] < 0 || static_cast<std::size_t>(values[i]) >= sizes[i])
            throw std::invalid_argument("a value of a feature is out of range");
        index = index * sizes[i] + static_cast<std::size_t>(values[i]);
    }
    tables_[static_cast<std::size_t>(feature_template)][index] = weight;
}

}  // namespace explicable
