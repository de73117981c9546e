#pragma once
#define AP_CUSTOMCONTROL_ENABLED 1
