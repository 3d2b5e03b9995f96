// What Pinocchio's own build writes, for its headers alone.
#pragma once
#define PINOCCHIO_DEPRECATED
#define PINOCCHIO_DEPRECATED_MESSAGE(message)
