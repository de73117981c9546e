"""The ledger: the paper's equations and claims, each judged against what is derived."""
