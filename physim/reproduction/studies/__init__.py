"""Claims in words as experiments, a module each; every module holds one `Study` named STUDY."""
