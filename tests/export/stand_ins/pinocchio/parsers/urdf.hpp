#pragma once
#include <pinocchio/model.hpp>
