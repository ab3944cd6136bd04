//! Pure: the plan's and the executor's values as the [`contract`] has them, and back.
//!
//! Both sides name every field and every variant, so that a new one does not compile before somebody has decided
//! what becomes of it on the wire. Values are moved, not copied.

mod executor;
mod plan;

use contract::Stamped;
use geodesy::LatLon;
use std::sync::Arc;

/// Says the same in another vocabulary: a domain type becomes its wire type, and a wire type its domain type.
pub trait Convert<T> {
    /// The same value.
    fn convert(self) -> T;
}

/// Types that are the same on both sides.
macro_rules! same {
    ($($type:ty),+) => {
        $(impl Convert<$type> for $type {
            fn convert(self) -> $type {
                self
            }
        })+
    };
}
same!(bool, u64, usize, f64, String, Arc<str>, LatLon);

impl<T, U: Convert<T>> Convert<Option<T>> for Option<U> {
    fn convert(self) -> Option<T> {
        self.map(U::convert)
    }
}

impl<T, U: Convert<T>> Convert<Vec<T>> for Vec<U> {
    fn convert(self) -> Vec<T> {
        self.into_iter().map(U::convert).collect()
    }
}

impl<T, E, U: Convert<T>, F: Convert<E>> Convert<Result<T, E>> for Result<U, F> {
    fn convert(self) -> Result<T, E> {
        self.map(U::convert).map_err(F::convert)
    }
}

impl<T, U: Convert<T>> Convert<Stamped<T>> for Stamped<U> {
    fn convert(self) -> Stamped<T> {
        let Stamped { time_s, validity_s, value } = self;
        Stamped { time_s, validity_s, value: value.convert() }
    }
}

/// Both directions between two structs with the same fields.
macro_rules! same_fields {
    ($domain:ty = $wire:ty { $($field:ident),+ $(,)? }) => {
        $crate::same_fields!(@one $domain => $wire { $($field),+ });
        $crate::same_fields!(@one $wire => $domain { $($field),+ });
    };
    (@one $from:ty => $to:ty { $($field:ident),+ }) => {
        impl $crate::Convert<$to> for $from {
            fn convert(self) -> $to {
                type From = $from;
                type To = $to;
                let From { $($field),+ } = self;
                To { $($field: $crate::Convert::convert($field)),+ }
            }
        }
    };
}

/// Both directions between two enums with the same variants.
macro_rules! same_variants {
    ($domain:ty = $wire:ty { $($variants:tt)+ }) => {
        $crate::same_variants!(@one $domain => $wire { $($variants)+ });
        $crate::same_variants!(@one $wire => $domain { $($variants)+ });
    };
    (@one $from:ty => $to:ty {
        $($variant:ident $(($value:ident))? $({ $($field:ident),+ })?),+ $(,)?
    }) => {
        impl $crate::Convert<$to> for $from {
            fn convert(self) -> $to {
                type From = $from;
                type To = $to;
                match self {
                    $(From::$variant $(($value))? $({ $($field),+ })? =>
                        To::$variant $(($crate::Convert::convert($value)))?
                            $({ $($field: $crate::Convert::convert($field)),+ })?,)+
                }
            }
        }
    };
}

use {same_fields, same_variants};
