#pragma once

#include <httplib.h>

// A macro of <resolv.h>, which httplib includes; Eigen's headers use the name for a parameter.
#undef _res
