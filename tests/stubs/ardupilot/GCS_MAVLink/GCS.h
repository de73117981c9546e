#pragma once
#include "../ardupilot.h"
