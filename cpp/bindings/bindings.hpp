#pragma once

#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_task(nb::module_& module);  // task and grounding
void bind_search(nb::module_& module);
void bind_labelling(nb::module_& module);
void bind_scorer(nb::module_& module);
