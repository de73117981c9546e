#include "../ardupilot.h"
