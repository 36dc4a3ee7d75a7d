#pragma once

#include "pipeline/mark/mark_session.h"

namespace touchtrace {

/// Serves the page on which boxes are drawn until the user ends it there. Reports its address.
/// `port` 0: any free port.
void serve_mark_page(MarkSession& session, int port);

}  // namespace touchtrace
