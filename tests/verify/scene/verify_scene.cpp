#include "tests/verify/scene/verify_scene.h"

#include <fmt/core.h>

#include "pipeline/scene/base/scene.h"
#include "pipeline/scene/person/activity.h"
#include "tests/verify/scene/ball_closed_forms.h"
#include "tests/verify/scene/closed_forms.h"
#include "tests/verify/verifications.h"

namespace touchtrace::scene {
namespace {

using Emit = std::function<void(Figure)>;

void verify_forms(const std::vector<ClosedForm>& forms, const Emit& emit) {
  for (const ClosedForm& form : forms) {
    const std::string at = fmt::format(", {:g} ms", 1e3 * form.step_s);
    if (form.min_order == 0.0) {
      emit(at_most(form.name + at, form.error(form.step_s), form.unit, form.max_error));
      continue;
    }
    const Picture::Curve curve = convergence(form);
    emit(at_most(form.name + at, curve.y.front(), form.unit, form.max_error));
    Figure order = at_least(form.name + ": order in the step", order_of_convergence(curve), "",
                            form.min_order);
    order.picture = {
        "step / s", "error" + (form.unit.empty() ? "" : " / " + form.unit), true, true, {curve}};
    emit(std::move(order));
  }
}

}  // namespace

Verification verify_scene() {
  return [](const Emit& emit) {
    for (const std::string& activity : activity_names()) {
      verify_speed(activity, emit);
      verify_rendering(activity, emit);
    }
    verify_inertial(emit);
    verify_forms(closed_forms(), emit);
    verify_forms(ball_closed_forms(), emit);
    verify_precision(emit);
    verify_extremes(emit);
    for (const std::string& activity : activity_names()) {
      verify_probe(activity, emit);
      verify_objects(activity, emit);
    }
    verify_balance(emit);
  };
}

}  // namespace touchtrace::scene
