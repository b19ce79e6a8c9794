#include <nanobind/stl/optional.h>
#include <nanobind/ndarray.h>

#include <stdexcept>
#include <utility>
#include <vector>

#include "bindings/bindings.hpp"
#include "labelling/chain.hpp"
#include "labelling/loss.hpp"

namespace {

using namespace explicable;

template <class T>
using Vector = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <class T>
using Matrix = nb::ndarray<const T, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

template <class Array>
auto span_of(const Array& array) {
    return std::span(array.data(), array.size());
}

template <class T>
std::vector<T> copy_of(const Vector<T>& array) {
    return {array.data(), array.data() + array.size()};
}

// Hands a vector over to NumPy.
template <class T>
nb::object to_numpy(std::vector<T>&& values, std::initializer_list<std::size_t> shape) {
    auto* owned = new std::vector<T>(std::move(values));
    nb::capsule owner(owned, [](void* pointer) noexcept { delete static_cast<std::vector<T>*>(pointer); });
    return nb::cast(nb::ndarray<nb::numpy, T>(owned->data(), shape, owner));
}

void require(bool condition, const char* message) {
    if (!condition) throw std::invalid_argument(message);
}

FeatureRows rows_of(const Vector<std::int64_t>& offsets, const Vector<std::int32_t>& features,
                    const Vector<double>& values) {
    return {copy_of(offsets), copy_of(features), copy_of(values)};
}

// Checks everything that the passes over chains take for granted.
Chain chain_of(const Matrix<double>& state, const Matrix<double>& transition, const Vector<LabelId>& clamped) {
    const std::size_t num_labels = transition.shape(0);
    require(num_labels >= 1 && num_labels <= 1 << 15, "the number of labels is out of range");
    require(transition.shape(1) == num_labels && state.shape(1) == num_labels,
            "state and transition scores differ in the number of labels");
    require(are_usable_scores(span_of(state)) && are_usable_scores(span_of(transition)),
            "scores are not finite, or too large");
    require(clamped.size() == 0 || clamped.size() == state.shape(0), "one clamped label is needed for each position");
    for (const LabelId label : span_of(clamped))
        require(label >= kAnyLabel && label < static_cast<LabelId>(num_labels), "a clamped label is out of range");
    return {static_cast<int>(num_labels), span_of(state), span_of(transition), span_of(clamped)};
}

}  // namespace

void bind_labelling(nb::module_& module) {
    module.def(
        "state_scores",
        [](const Vector<std::int64_t>& offsets, const Vector<std::int32_t>& features, const Vector<double>& values,
           const Matrix<double>& weights) {
            const FeatureRows rows = rows_of(offsets, features, values);
            std::vector<double> state;
            {
                nb::gil_scoped_release release;
                check_rows(rows, static_cast<std::int64_t>(weights.shape(0)));
                state.resize(rows.size() * weights.shape(1));
                state_scores(rows, static_cast<int>(weights.shape(1)), span_of(weights), state);
            }
            return to_numpy(std::move(state), {rows.size(), weights.shape(1)});
        },
        nb::arg("offsets").noconvert(), nb::arg("features").noconvert(), nb::arg("values").noconvert(),
        nb::arg("weights").noconvert());
    module.def(
        "viterbi",
        [](const Matrix<double>& state, const Matrix<double>& transition, const Vector<LabelId>& clamped) {
            const Chain chain = chain_of(state, transition, clamped);
            std::vector<LabelId> labels(chain.num_positions());
            {
                nb::gil_scoped_release release;
                viterbi(chain, labels);
            }
            return to_numpy(std::move(labels), {state.shape(0)});
        },
        nb::arg("state").noconvert(), nb::arg("transition").noconvert(), nb::arg("clamped").noconvert());
    module.def(
        "marginals",
        [](const Matrix<double>& state, const Matrix<double>& transition, const Vector<LabelId>& clamped) {
            const Chain chain = chain_of(state, transition, clamped);
            std::vector<double> probabilities(state.size());
            {
                nb::gil_scoped_release release;
                marginals(chain, probabilities);
            }
            return to_numpy(std::move(probabilities), {state.shape(0), state.shape(1)});
        },
        nb::arg("state").noconvert(), nb::arg("transition").noconvert(), nb::arg("clamped").noconvert());
    module.def(
        "count_distribution",
        [](const Matrix<double>& state, const Matrix<double>& transition, const Vector<LabelId>& clamped,
           LabelId empty, const Vector<std::uint8_t>& counted) {
            const Chain chain = chain_of(state, transition, clamped);
            require(counted.size() == 0 || counted.size() == state.shape(0), "one flag is needed for each position");
            std::vector<double> distribution;
            {
                nb::gil_scoped_release release;
                distribution = count_distribution(chain, empty, span_of(counted));
            }
            const std::size_t size = distribution.size();
            return to_numpy(std::move(distribution), {size});
        },
        nb::arg("state").noconvert(), nb::arg("transition").noconvert(), nb::arg("clamped").noconvert(),
        nb::arg("empty"), nb::arg("counted").noconvert());

    nb::class_<SequenceLoss>(module, "SequenceLoss")
        .def(
            "__init__",
            [](SequenceLoss* self, int num_labels, std::int64_t num_features, const Vector<std::int64_t>& row_offsets,
               const Vector<std::int32_t>& row_features, const Vector<double>& row_values,
               const Vector<std::int64_t>& offsets, const Vector<std::int32_t>& position_rows,
               const Vector<LabelId>& position_labels, const std::optional<Vector<LabelId>>& position_given) {
                new (self) SequenceLoss(num_labels, num_features, rows_of(row_offsets, row_features, row_values),
                                        copy_of(offsets), copy_of(position_rows), copy_of(position_labels),
                                        position_given ? copy_of(*position_given) : std::vector<LabelId>());
            },
            nb::arg("num_labels"), nb::arg("num_features"), nb::arg("row_offsets").noconvert(),
            nb::arg("row_features").noconvert(), nb::arg("row_values").noconvert(), nb::arg("offsets").noconvert(),
            nb::arg("position_rows").noconvert(), nb::arg("position_labels").noconvert(),
            nb::arg("position_given").noconvert().none() = nb::none())
        .def(
            "__call__",
            [](const SequenceLoss& self, const Vector<double>& weights, const Vector<double>& sequence_weights) {
                std::vector<double> gradient;
                double loss = 0.0;
                {
                    nb::gil_scoped_release release;
                    require(weights.size() == self.num_weights(), "wrong number of weights");
                    gradient.resize(weights.size());
                    loss = self(span_of(weights), span_of(sequence_weights), gradient);
                }
                return nb::make_tuple(loss, to_numpy(std::move(gradient), {weights.size()}));
            },
            nb::arg("weights").noconvert(), nb::arg("sequence_weights").noconvert());
}
