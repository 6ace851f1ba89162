#pragma once

#include "mapping/base/math.h"  // deprecated: include that
