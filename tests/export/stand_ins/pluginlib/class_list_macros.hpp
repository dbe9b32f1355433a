#pragma once
#define PLUGINLIB_EXPORT_CLASS(kind, base) template class std::unique_ptr<kind>;
