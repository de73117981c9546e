/* Nothing of it is needed to mix. */
#pragma once
